"""commands_test.py ROOT PROGRAM: the tutorial's commands run as they stand, one after the other in an empty folder. Those
of its last section need the sources and have a test of their own. Exit code 77 where a program that it calls is missing."""

import os
import shutil
import subprocess
import sys
import tempfile

from tutorial_pages import tutorial_blocks

ROOT, PROGRAM = sys.argv[1:]


def main():
    if not shutil.which("cbc"):
        print("skipped: there is no cbc (Debian: apt-get install coinor-cbc)")
        return 77
    commands = tutorial_blocks(ROOT, "sh")
    assert len(commands) >= 5, "the tutorial has lost its commands"
    with tempfile.TemporaryDirectory() as folder:
        programs = os.path.join(folder, "programs")
        work = os.path.join(folder, "work")
        os.mkdir(programs)
        os.mkdir(work)
        os.symlink(PROGRAM, os.path.join(programs, "conelane"))
        environment = os.environ | {"PATH": programs + os.pathsep + os.environ["PATH"]}
        for block in commands:
            done = subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=work, env=environment, capture_output=True,
                                  text=True, check=False)
            if done.returncode != 0:
                print(f"exit code {done.returncode} of\n{block}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
                return 1
        for name in ("exact.certificates.jsonl", "cbc.solutions.jsonl", "results/report.html", "again.html", "scene.svg"):
            if os.path.getsize(os.path.join(work, name)) == 0:
                print(f"{name} is empty")
                return 1
    print(f"{len(commands)} blocks of commands")
    return 0


if __name__ == "__main__":
    sys.exit(main())
