"""Builds the module of the package with the CMake project around this folder."""
import re
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

PROJECT = Path(__file__).resolve().parent.parent


def project_version() -> str:
    text = (PROJECT / "CMakeLists.txt").read_text(encoding="utf-8")
    match = re.search(r"project\(conelane VERSION ([0-9.]+)", text)
    if match is None:
        raise RuntimeError("CMakeLists.txt names no version")
    return match.group(1)


class CMakeBuild(build_ext):
    """The one extension is a target of CMake."""

    def build_extension(self, ext: Extension) -> None:
        build = Path(self.build_temp).resolve() / "cmake"
        module = Path(self.get_ext_fullpath(ext.name)).resolve()
        options = [
            "-DCMAKE_BUILD_TYPE=Release",
            "-DCONELANE_PYTHON=ON",
            "-DCONELANE_BUILD_EXPERIMENTS=OFF",
            "-DBUILD_TESTING=OFF",
            f"-DPython_EXECUTABLE={sys.executable}",
            f"-DCONELANE_PYTHON_MODULE_DIR={module.parent}",
        ]
        try:
            import pybind11  # of pip's build environment; else CMake finds the system's

            options.append(f"-Dpybind11_DIR={pybind11.get_cmake_dir()}")
        except ImportError:
            pass
        subprocess.run(["cmake", "-S", str(PROJECT), "-B", str(build), *options], check=True)
        subprocess.run(["cmake", "--build", str(build), "--target", "conelane_python", "--parallel"], check=True)


setup(version=project_version(), ext_modules=[Extension("conelane._core", sources=[])],
      cmdclass={"build_ext": CMakeBuild})
