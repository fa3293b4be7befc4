"""commands_test.py ROOT PROGRAM [COMPILER FLAG...]: the tutorial's commands run as they stand, one after the other in an
empty folder, and its C++ compiles. Exit code 77 where a program that it calls is missing."""

import os
import re
import shutil
import subprocess
import sys
import tempfile

ROOT, PROGRAM, COMPILER = sys.argv[1], sys.argv[2], sys.argv[3:]
PAGE = os.path.join(ROOT, "docs", "tutorial-researcher.md")


def blocks(language):
    with open(PAGE, encoding="utf-8") as stream:
        return re.findall(rf"^```{language}\n(.*?)^```$", stream.read(), flags=re.M | re.S)


def main():
    if not shutil.which("cbc"):
        print("skipped: there is no cbc (Debian: apt-get install coinor-cbc)")
        return 77
    commands = blocks("sh")
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
        for number, code in enumerate(blocks("cpp") if COMPILER else ()):
            source = os.path.join(folder, f"code_{number}.cpp")
            with open(source, "w", encoding="utf-8") as stream:
                stream.write(code)
            done = subprocess.run([*COMPILER, "-fsyntax-only", source], capture_output=True, text=True, check=False)
            if done.returncode != 0:
                print(f"does not compile:\n{done.stderr[-3000:]}")
                return 1
    print(f"{len(commands)} blocks of commands, {len(blocks('cpp'))} of code")
    return 0


if __name__ == "__main__":
    sys.exit(main())
