"""setup_test.py SOURCES: pip builds with as many jobs as CMAKE_BUILD_PARALLEL_LEVEL says."""

import os
import subprocess
import sys
import sysconfig
import tempfile
import unittest
from pathlib import Path

SOURCES = Path(sys.argv.pop(1))


class Jobs(unittest.TestCase):
    def parallel(self, **environment):
        """What setup.py passes to a `cmake` that only writes down its arguments."""
        with tempfile.TemporaryDirectory() as folder:
            log, cmake = Path(folder, "log"), Path(folder, "cmake")
            cmake.write_text(f"#!/bin/sh\necho \"$*\" >>{log}\n", encoding="utf-8")
            cmake.chmod(0o755)
            built = Path(folder, "build", "python", "conelane", "_core" + sysconfig.get_config_var("EXT_SUFFIX"))
            built.parent.mkdir(parents=True)
            for file in (built, built.parent / "_core.pyi"):
                file.touch()
            names = {key: value for key, value in os.environ.items() if key != "CMAKE_BUILD_PARALLEL_LEVEL"}
            subprocess.run([sys.executable, "-B", "setup.py", "-q", "build_ext", "--build-lib", folder], check=True,
                           cwd=SOURCES / "python", env={**names, "PATH": f"{folder}:{names['PATH']}",
                                                        "CONELANE_BUILD_DIR": str(Path(folder, "build")), **environment})
            return log.read_text(encoding="utf-8").split()[-2:]

    def test_the_environment_says_how_many(self):
        self.assertEqual(self.parallel(CMAKE_BUILD_PARALLEL_LEVEL="3"), ["--parallel", "3"])
        self.assertEqual(self.parallel(), ["--parallel", str(os.cpu_count())])


if __name__ == "__main__":
    unittest.main()
