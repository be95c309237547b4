"""Trajectories as PedPy reads them: text with a line "id frame x y z" a person and frame, m, and the frame rate in the head."""

import re

import numpy as np


class Writer:
    """Writes frames to a file, as `with Writer("run.txt", frame_rate=10) as out: out.add(ids, positions)`.

    Everything that add() was given is in the file when it returns.
    """

    def __init__(self, file, frame_rate):
        if not frame_rate > 0:
            raise ValueError(f"frame_rate is {frame_rate}; expected above 0 (1/s)")
        self._frame = 0
        self._out = open(file, "w", encoding="ascii")
        self._out.write(f"# framerate: {frame_rate:g} fps\n# id frame x/m y/m z/m\n")

    def add(self, ids, positions):
        """The next frame. ids: n whole numbers; positions: n x 2 or n x 3, m."""
        ids, positions = np.asarray(ids), np.asarray(positions, dtype=np.float64)
        if positions.ndim != 2 or positions.shape[1] not in (2, 3) or ids.shape != positions.shape[:1]:
            raise ValueError(f"positions has the shape {positions.shape} for ids of the shape {ids.shape}; expected (n, 2) or (n, 3)")
        if not np.isfinite(positions).all():
            raise ValueError("positions has values that are not finite")
        for person, place in zip(ids, positions):
            self._out.write(f"{int(person)} {self._frame} {place[0]:.4f} {place[1]:.4f} 0\n")
        self._out.flush()
        self._frame += 1

    def close(self):
        self._out.close()

    def __enter__(self):
        return self

    def __exit__(self, *of_what):
        self.close()


def read(file):
    """Returns (frame rate, table): a structured array with the columns id, frame, x and y."""
    with open(file, encoding="ascii") as lines:
        text = lines.read()
    rate = re.search(r"^#.*?framerate:?\s*([0-9.]+)", text, re.MULTILINE | re.IGNORECASE)
    if not rate:
        raise ValueError(f"{file}: no frame rate in the head; expected '# framerate: 10 fps'")
    rows = []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        words = line.split()
        try:
            rows.append((int(words[0]), int(words[1]), float(words[2]), float(words[3])))
        except (ValueError, IndexError):
            raise ValueError(f"{file}:{number}: is {line[:60]!r}; expected id frame x y") from None
    return float(rate[1]), np.array(rows, dtype=[("id", "i8"), ("frame", "i8"), ("x", "f8"), ("y", "f8")])
