"""Runs a solver on all programs of a library that `conelane instances` made.

    run_solver.py LIBRARY OUT [--limit-s 60] [--classes easy,hard,open] [--formulation tight] -- COMMAND...

COMMAND is run by /bin/sh for each program, with the placeholders {mps} {sol} {limit_s} {limit_ms} {limit_whole_s} {gap} {threads} {seed}
filled in, as `exec:` of `conelane study backends` fills them: experiments/adapters/ has commands. The programs are unpacked. A command that runs
longer than its limit and 10 s is killed. OUT gets NAME.sol, NAME.log, command.txt and runs.csv (name, exit code, seconds); programs that runs.csv
names are not run again, and another COMMAND needs another OUT. Then: check_solutions.py LIBRARY OUT.
"""

import argparse
import csv
import gzip
import math
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

GRACE_S = 10.0
CLASSES = "easy,hard,open"


def index_of(library):
    with open(os.path.join(library, "index.csv"), newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def name_of(row):
    return row["file"].removesuffix(".mps.gz")


def run(command, log, limit_s):
    """Exit code and seconds; the code of a killed command is negative."""
    start = time.monotonic()
    with open(log, "wb") as output:
        process = subprocess.Popen(["/bin/sh", "-c", command], stdin=subprocess.DEVNULL, stdout=output, stderr=output, start_new_session=True)
        try:
            code = process.wait(limit_s + GRACE_S)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            code = process.wait()
    return code, time.monotonic() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0], usage="run_solver.py LIBRARY OUT [OPTION]... -- COMMAND...")
    parser.add_argument("library")
    parser.add_argument("out")
    parser.add_argument("--limit-s", type=float, default=60.0, help="time limit of a program")
    parser.add_argument("--classes", default=CLASSES, help="classes of the index, separated by commas")
    parser.add_argument("--formulation", choices=["tight", "printed"], help="one formulation only")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("command", nargs="+")
    options = parser.parse_args()
    if not os.path.exists(os.path.join(options.library, "index.csv")):
        parser.error(f"{options.library} holds no index.csv: `conelane instances` makes it")
    classes = options.classes.split(",")
    if unknown := [name for name in classes if name not in CLASSES.split(",")]:
        parser.error(f"--classes: there is no class '{unknown[0]}'; classes are {CLASSES}")
    os.makedirs(options.out, exist_ok=True)
    table, command_file = os.path.join(options.out, "runs.csv"), pathlib.Path(options.out, "command.txt")
    done = set()
    if os.path.exists(table):
        with open(table, newline="", encoding="utf-8") as stream:
            done = {row["name"] for row in csv.DictReader(stream)}
    rows = [row for row in index_of(options.library) if row["class"] in classes and
            options.formulation in (None, row["formulation"])]
    command = " ".join(options.command)
    stored = command_file.read_bytes() if command_file.exists() else b"an unknown command"
    if done and stored != os.fsencode(command):
        parser.error(f"{options.out} has runs of {os.fsdecode(stored)}: name another folder")
    command_file.write_bytes(os.fsencode(command))
    there = sum(name_of(row) in done for row in rows)
    print(f"{there} of {len(rows)} already there, {len(rows) - there} to run", file=sys.stderr)
    with open(table, "a", newline="", encoding="utf-8") as stream, tempfile.TemporaryDirectory() as folder:
        writer = csv.writer(stream)
        if not done and stream.tell() == 0:
            writer.writerow(["name", "exit_code", "seconds", "limit_s"])
        for place, row in enumerate(rows, 1):
            name = name_of(row)
            if name in done:
                continue
            mps, solution = os.path.join(folder, "program.mps"), os.path.join(options.out, name + ".sol")
            pathlib.Path(solution).unlink(missing_ok=True)  # of an earlier run
            with gzip.open(os.path.join(options.library, row["file"])) as packed, open(mps, "wb") as unpacked:
                shutil.copyfileobj(packed, unpacked)
            filled = command
            for placeholder, value in (("{mps}", mps), ("{sol}", os.path.abspath(solution)), ("{limit_s}", f"{options.limit_s:g}"),
                                       ("{limit_ms}", f"{1000.0 * options.limit_s:g}"), ("{limit_whole_s}", str(math.ceil(options.limit_s))),
                                       ("{gap}", "1e-09"), ("{threads}", "1"), ("{seed}", str(options.seed)), ("{cutoff}", "1e300")):
                filled = filled.replace(placeholder, value)
            code, seconds = run(filled, os.path.join(options.out, name + ".log"), options.limit_s)
            writer.writerow([name, code, f"{seconds:.4f}", f"{options.limit_s:g}"])
            stream.flush()
            print(f"{place} of {len(rows)}: {name}, {seconds:.2f} s" + (f", exit code {code}" if code else ""), file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
