"""packages_test.py SOURCES: what .ci/package makes: the wheel is installed in seconds in an environment of its own and finds a lane, the
source distribution has nothing but the core, and the Debian package has program, library and Python package. Minutes; skipped (77)
without the tools of packages."""
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
import unittest
from importlib.util import find_spec
from pathlib import Path

SOURCES = Path(sys.argv.pop(1))
for missing in [tool for tool in ("cmake", "ninja", "cpack", "dpkg-deb", "dpkg-shlibdeps") if not shutil.which(tool)] + [
        module for module in ("setuptools", "wheel", "pip", "venv") if not find_spec(module)]:
    print(f"skipped: no {missing}")
    sys.exit(77)


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = Path(cls.folder.name, "dist")
        made = os.environ.get("CONELANE_PACKAGES")  # of an earlier call
        if made:
            shutil.copytree(made, cls.out)
        else:
            subprocess.run([SOURCES / ".ci" / "package", cls.out], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def one(self, ending):
        file, = self.out.glob(f"*{ending}")
        return file

    def test_the_wheel(self):
        environment = Path(self.folder.name, "env")
        subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", environment], check=True)
        start = time.monotonic()
        subprocess.run([environment / "bin" / "pip", "install", "-q", "--no-index", "--no-deps", self.one(".whl")], check=True)
        print(f"wheel installed in {time.monotonic() - start:.1f} s")
        where = subprocess.run([environment / "bin" / "python", "-c", "import conelane, pathlib; print(pathlib.Path(conelane.__file__).parents[1])"],
                               check=True, capture_output=True, text=True, cwd=self.folder.name, env={"PATH": os.environ["PATH"]}).stdout.strip()
        subprocess.run([environment / "bin" / "python", SOURCES / "tests" / "python" / "installed_test.py", where], check=True,
                       cwd=self.folder.name, env={"PATH": os.environ["PATH"]})
        log = Path(self.folder.name, "run.frames.jsonl")
        cones = ",".join(f'{{"x":{x},"y":{y}}}' for x in range(2, 30, 4) for y in (-1.5, 1.5))
        log.write_text("".join(f'{{"pose":{{"x":{i},"y":0,"yaw":0}},"cones":[{cones}]}}\n' for i in range(5)), encoding="utf-8")
        subprocess.run([environment / "bin" / "python", "-m", "conelane.replay", log, "--out", log.with_suffix(".html")], check=True,
                       cwd=self.folder.name, env={"PATH": os.environ["PATH"]})
        self.assertIn("5 frames", log.with_suffix(".html").read_text(encoding="utf-8"))
        absent = subprocess.run([environment / "bin" / "python", "-c", "import conelane; conelane.load_tracks"], capture_output=True, text=True,
                                cwd=self.folder.name, env={"PATH": os.environ["PATH"]})
        self.assertIn("this build is the core alone", absent.stderr)

    def test_the_source_distribution_compiles_the_core_alone(self):
        with tarfile.open(self.one(".tar.gz")) as archive:
            names = [name.partition("/")[2] for name in archive.getnames()]
        compiled = {name.split("/")[1] for name in names if name.endswith(".cpp")}
        self.assertEqual(compiled, {"model", "solvers", "graph_search", "detectors", "python"})

    def test_the_debian_package(self):
        files = subprocess.run(["dpkg-deb", "--contents", self.one(".deb")], check=True, capture_output=True, text=True).stdout
        fields = subprocess.run(["dpkg-deb", "--field", self.one(".deb")], check=True, capture_output=True, text=True).stdout
        self.assertRegex(fields, r"Depends: .*libeigen3-dev.*python3 \(<< 3\.\d+\)")
        self.assertRegex(fields, r"Maintainer: The conelane authors <.*\.invalid>\n")
        for name in ("./usr/bin/conelane\n", "./usr/share/doc/conelane/copyright\n", "./usr/include/conelane/planner.hpp", "/cmake/conelane/conelaneConfig.cmake", "libconelane_detectors.a",
                     "./usr/lib/python3/dist-packages/conelane/page/replay.py"):
            self.assertIn(name, files)
        root = Path(self.folder.name, "root")
        subprocess.run(["dpkg-deb", "--extract", self.one(".deb"), root], check=True)
        version = subprocess.run([root / "usr" / "bin" / "conelane", "--version"], check=True, capture_output=True, text=True).stdout
        field = subprocess.run(["dpkg-deb", "--field", self.one(".deb"), "Version"], check=True, capture_output=True, text=True).stdout
        self.assertIn(f"conelane {field.strip()}\n", version)
        subprocess.run(["/usr/bin/python3", SOURCES / "tests" / "python" / "installed_test.py", root / "usr/lib/python3/dist-packages"], check=True,
                       env={"PYTHONPATH": str(root / "usr/lib/python3/dist-packages"), "PATH": os.environ["PATH"]})


if __name__ == "__main__":
    unittest.main()
