"""Walls and areas as shapely and JuPedSim say them: polygons, lines, collections of these, and WKT."""

import numpy as np


def _ring(ring):
    """The points of a ring of shapely, whose last one repeats the first."""
    return np.asarray(ring.coords, dtype=np.float64)[:-1, :2]


def _parts(shape):
    return shape.geoms if hasattr(shape, "geoms") else [shape]


def add_walls(scene, geometry, repair=False, **fields):
    """Adds walls along what is given, all or none, and returns their handles.

    geometry: WKT; a Polygon, LineString or LinearRing of shapely, or a collection of them; or a list of any of these.
    repair: whether polygons in WKT that are not valid are mended instead of refused.
    fields: of WallDefinition, such as friction: see Scene.add_wall.
    """
    walls = []
    try:
        for item in geometry if isinstance(geometry, (list, tuple)) else [geometry]:
            if isinstance(item, str):
                walls.extend(scene._add_wkt(item, repair, **fields))
                continue
            if not hasattr(item, "geom_type"):
                raise TypeError(f"geometry is {item!r:.60}; expected WKT, or a geometry of shapely")
            for part in _parts(item):
                if part.geom_type == "Polygon":
                    walls.extend(scene._add_rings(_ring(part.exterior), [_ring(hole) for hole in part.interiors], **fields))
                elif part.geom_type == "LinearRing":
                    walls.append(scene.add_wall(_ring(part), closed=True, **fields))
                elif part.geom_type == "LineString":
                    walls.append(scene.add_wall(np.asarray(part.coords, dtype=np.float64)[:, :2], **fields))
                else:
                    raise TypeError(f"geometry has a {part.geom_type}; expected polygons and lines")
    except BaseException:
        for wall in walls:
            scene.remove_wall(int(wall))
        raise
    return np.array(walls, dtype=np.uint64)


def people_inside(index, polygon):
    """The handles of those of a CrowdIndex whose centres are in a polygon of shapely."""
    return index._inside(_ring(polygon.exterior), [_ring(hole) for hole in polygon.interiors])
