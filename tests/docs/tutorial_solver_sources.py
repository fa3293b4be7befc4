"""tutorial_solver_sources.py ROOT FOLDER: what a reader of the tutorial has after adding its solver: its files, and
those of the list of solvers with its patch, all in FOLDER."""

import os
import re
import shutil
import subprocess
import sys

from tutorial_pages import text_of, tutorial_blocks

ROOT, FOLDER = sys.argv[1:]
PATCHED = ("solvers/CMakeLists.txt", "solvers/core_entries.hpp", "solvers/core_solvers.cpp")


def patch(text, *options):
    return subprocess.run(["patch", "-p1", "--force", "--fuzz=0", *options], input=text, cwd=FOLDER, capture_output=True, text=True, check=False)


def main():
    shutil.rmtree(FOLDER, ignore_errors=True)
    os.makedirs(os.path.join(FOLDER, "solvers"))
    for name in PATCHED:
        shutil.copyfile(os.path.join(ROOT, name), os.path.join(FOLDER, name))
    (changes,) = tutorial_blocks(ROOT, "diff")
    # A reader who has followed the page has the lines already.
    if patch(changes, "--reverse", "--dry-run").returncode != 0:
        done = patch(changes, "--forward")
        if done.returncode != 0:
            sys.exit(f"the tutorial's patch does not apply:\n{done.stdout}{done.stderr}")
    compiled = re.search(r"SOURCES([^)]*?)\bPUBLIC\b", text_of(os.path.join(FOLDER, "solvers", "CMakeLists.txt"))).group(1).split()
    for code in tutorial_blocks(ROOT, "cpp"):
        name = re.match(r"// (solvers/\w+\.[ch]pp)\n", code)
        if not name:
            sys.exit(f"the first line names no file:\n{code}")
        if name.group(1).endswith(".cpp") and os.path.basename(name.group(1)) not in compiled:
            sys.exit(f"solvers/CMakeLists.txt does not compile {name.group(1)}")
        with open(os.path.join(FOLDER, name.group(1)), "w", encoding="utf-8") as stream:
            stream.write(code)


if __name__ == "__main__":
    main()
