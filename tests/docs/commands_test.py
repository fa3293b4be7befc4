"""commands_test.py ROOT PROGRAM: the tutorial's commands run as they stand, one after the other in an empty folder. Those
of its last section need the sources and have a test of their own. The way from a clone to the page has at most ten commands;
those of the program run here, with the comparison of the other sections. Exit code 77 where a program that it calls is missing."""

import json
import os
import shutil
import subprocess
import sys
import tempfile

from tutorial_pages import tutorial_blocks

ROOT, PROGRAM = sys.argv[1:]


MOST_COMMANDS = 10


def short_way():
    """The commands from a clone to a page with a row of the reader's solver."""
    (block,) = [block for block in tutorial_blocks(ROOT, "bash") if block.startswith("git clone ")]
    return block.replace("\\\n", "").splitlines()


def main():
    if not shutil.which("cbc"):
        print("skipped: there is no cbc (Debian: apt-get install coinor-cbc)")
        return 77
    short = short_way()
    assert len(short) <= MOST_COMMANDS, f"{len(short)} commands from a clone to the page"
    of_program = [command for command in short if command.startswith("conelane ")]
    assert len(of_program) >= 3, "the short way has lost its commands"
    commands = tutorial_blocks(ROOT, "sh")
    assert len(commands) >= 5, "the tutorial has lost its commands"
    commands += of_program
    with tempfile.TemporaryDirectory() as folder:
        programs = os.path.join(folder, "programs")
        work = os.path.join(folder, "work")
        os.mkdir(programs)
        os.mkdir(work)
        os.symlink(PROGRAM, os.path.join(programs, "conelane"))
        os.symlink(os.path.join(ROOT, "experiments"), os.path.join(work, "experiments"))
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
        with open(os.path.join(work, "results", "backends.jsonl"), encoding="utf-8") as stream:
            # The smallest size only: larger ones may take longer than the limit and a second where other programs run.
            answers = [row for row in map(json.loads, stream) if row.get("backend") == "mine/tight" and "scene" in row and row["nearest"] == 12]
        wrong = [row for row in answers if row["status"] == "error"]
        if not answers or wrong:
            print(f"{len(wrong)} of {len(answers)} answers of the reader's solver are errors: {wrong[:1]}")
            return 1
        with open(os.path.join(work, "page.html"), encoding="utf-8") as stream:
            page = stream.read()
        if "mine/tight" not in page.partition('<div class="table" id="solver-measures">')[2].partition("</table>")[0]:
            print("the table solver-measures of the page has no row of the reader's solver")
            return 1
    print(f"{len(commands)} blocks of commands")
    return 0


if __name__ == "__main__":
    sys.exit(main())
