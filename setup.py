"""Builds the module motley._motley by CMake, which also gets the options in the variable CMAKE_ARGS, and takes the version from
CMakeLists.txt."""

import os
import pathlib
import re
import shlex
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

root = pathlib.Path(__file__).parent.resolve()


class BuildByCMake(build_ext):
    def build_extension(self, extension):
        target = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        build = root / "build/python"
        subprocess.run(["cmake", "-S", root, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                        "-DMOTLEY_BUILD_TESTS=OFF", "-DMOTLEY_BUILD_BENCH=OFF", "-DMOTLEY_PYTHON=ON", "-DBUILD_SHARED_LIBS=OFF",
                        f"-DPython_EXECUTABLE={sys.executable}", *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)
        subprocess.run(["cmake", "--build", build, "--target", "motley_python"], check=True)
        target.parent.mkdir(parents=True, exist_ok=True)
        self.copy_file(str(build / "parallel/python/motley" / target.name), str(target))


version = re.search(r"VERSION ([0-9.]+)", (root / "CMakeLists.txt").read_text().split("project(", 1)[1])[1]
setup(version=version, ext_modules=[Extension("motley._motley", [])], cmdclass={"build_ext": BuildByCMake})
