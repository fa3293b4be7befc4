"""Builds the module of the package with the CMake project around this folder."""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from setuptools.command.sdist import sdist

HERE = Path(__file__).resolve().parent
IS_SDIST = (HERE / "core").is_dir()
PROJECT = HERE / "core" if IS_SDIST else HERE.parent
BUILD = PROJECT / "build" / "pip"  # all that is made on the way, so that this folder stays clean
# What a source distribution has of the project: the core, and of the rest single files.
CORE = ["CMakeLists.txt", "LICENSE", "cmake", "model", "solvers", "graph_search", "detectors", "python/CMakeLists.txt", "python/stubs.py",
        "python/bindings", "python/conelane", "evaluation/input_error.hpp", "evaluation/formats/lane_file.hpp",
        "evaluation/world/annotated_scene.hpp"]
PAGE = [f"experiments/report/{name}" for name in (
    "__init__.py", "replay.py", "records.py", "drawing.mjs", "frames.js", "race.js", "tables.js", "marks.json", "style.css")]


def project_version() -> str:
    text = (PROJECT / "CMakeLists.txt").read_text(encoding="utf-8")
    match = re.search(r"project\(conelane VERSION ([0-9.]+)", text)
    if match is None:
        raise RuntimeError("CMakeLists.txt names no version")
    return match.group(1)


class CMakeBuild(build_ext):
    """The one extension is a target of CMake, made in CONELANE_BUILD_DIR where that names a configured build."""

    def build_extension(self, ext: Extension) -> None:
        build = Path(os.environ.get("CONELANE_BUILD_DIR", BUILD / f"cmake-{sys.implementation.cache_tag}"))
        if "CONELANE_BUILD_DIR" not in os.environ:
            self.configure(build)
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL") or str(os.cpu_count() or 1)
        subprocess.run(["cmake", "--build", str(build), "--target", "conelane_python", "--parallel", jobs], check=True)
        target = Path(self.get_ext_fullpath(ext.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        for name in (target.name, "_core.pyi"):
            shutil.copy2(build / "python" / "conelane" / name, target.parent)
        (target.parent / "page").mkdir(exist_ok=True)
        for name in PAGE:
            shutil.copy2(PROJECT / name, target.parent / "page")

    @staticmethod
    def configure(build: Path) -> None:
        options = [
            "-DCMAKE_BUILD_TYPE=Release",
            "-DCONELANE_PYTHON=ON",
            "-DCONELANE_BUILD_EXPERIMENTS=OFF",
            "-DBUILD_TESTING=OFF",
            f"-DCONELANE_PYTHON_FILES={os.environ.get('CONELANE_PYTHON_FILES', 'OFF')}",
            f"-DPython_EXECUTABLE={sys.executable}",
        ]
        try:
            import pybind11  # of pip's build environment; else CMake finds the system's

            options.append(f"-Dpybind11_DIR={pybind11.get_cmake_dir()}")
        except ImportError:
            pass
        if shutil.which("ninja") and "CMAKE_GENERATOR" not in os.environ:
            options.append("-GNinja")  # CMake's default is make, which need not be there
        subprocess.run(["cmake", "-S", str(PROJECT), "-B", str(build), *options], check=True)


class SdistOfCore(sdist):
    """With what the extension is compiled from, in the folder `core`."""

    def make_release_tree(self, base_dir: str, files: list) -> None:
        super().make_release_tree(base_dir, files)
        for name in [*CORE, *PAGE]:
            source, target = PROJECT / name, Path(base_dir, "core", name)
            target.parent.mkdir(parents=True, exist_ok=True)
            if source.is_dir():
                shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__", "*.pyc"), dirs_exist_ok=True)
            else:
                shutil.copy2(source, target)


(BUILD / "info").mkdir(parents=True, exist_ok=True)
setup(
    version=project_version(),
    ext_modules=[Extension("conelane._core", sources=[])],
    cmdclass={"build_ext": CMakeBuild, "sdist": SdistOfCore},
    options={"build": {"build_base": str(BUILD)}, "egg_info": {"egg_base": str(BUILD / "info")}},
)
