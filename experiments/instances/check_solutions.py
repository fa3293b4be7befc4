"""Checks what a solver answered to the programs of a library, after run_solver.py.

    check_solutions.py LIBRARY OUT

Each point is tried in its program: rows, bounds and whole numbers within 1e-6, and its objective is computed again. A claimed optimum has to be
that of conelane.solu within 1e-6 of its size. The table has for each class how many programs are proven (a checked optimum, or infeasible
as the library says), only feasible, without a point, and wrong; the shifted geometric mean (10 ms) of the times, with what is not
proven at the limit; and the better points of open programs, which are listed below it. Exit code 1 if an answer is wrong.
"""

import csv
import math
import os
import sys
from collections import defaultdict

import mps
from run_solver import index_of, name_of

TOLERANCE = 1e-6
SHIFT_S = 0.01


def known_values(library):
    """(optimal value, best value, whether it is infeasible) by name, from conelane.solu."""
    known = defaultdict(dict)
    with open(os.path.join(library, "conelane.solu"), encoding="utf-8") as stream:
        for line in stream:
            mark, name, *value = line.split()
            known[name][mark] = float(value[0]) if value else None
    return known


def judged(program, solution, known):
    """(proven, feasible, none or wrong, what to say)"""
    best = known.get("=opt=", known.get("=best="))
    scale = max(1.0, abs(best)) if best is not None else 1.0
    if solution.status == "infeasible":
        if "=inf=" in known:
            return "proven", ""
        return ("wrong", f"claimed to be infeasible, has a point of {best:.9g}") if best is not None else ("none", "infeasible, not known to the library")
    # A claimed optimum without values is the point where all columns are 0.
    if solution.status != "optimal" and not (solution.status == "feasible" and solution.values):
        return "none", ""
    if broken := mps.violation(program, solution.values):
        return "wrong", broken
    value = mps.objective_of(program, solution.values)
    if solution.objective is not None and abs(value - solution.objective) > TOLERANCE * max(1.0, abs(value)):
        return "wrong", f"claims an objective of {solution.objective:.9g}, its point has {value:.9g}"
    if "=inf=" in known:
        return "wrong", "has a point, known to be infeasible"
    if "=opt=" in known and value < known["=opt="] - TOLERANCE * scale:
        return "wrong", f"its point of {value:.9g} is better than the optimum of the library, {known['=opt=']:.9g}: the library is wrong"
    if solution.status == "optimal":
        if best is not None and value > best + TOLERANCE * scale:
            return "wrong", f"claims {value:.9g} to be the optimum, there is a point of {best:.9g}"
        return "proven", ""
    if best is None or value < best - TOLERANCE * scale:
        return "feasible", f"a better point: {value:.9g}, best known {'none' if best is None else format(best, '.9g')}"
    return "feasible", ""


def main(arguments):
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    library, out = arguments
    known = known_values(library)
    with open(os.path.join(out, "runs.csv"), newline="", encoding="utf-8") as stream:
        runs = {row["name"]: row for row in csv.DictReader(stream)}
    cells, notes = defaultdict(list), []
    for row in index_of(library):
        name = name_of(row)
        if name not in runs:
            continue
        run = runs[name]
        answer = os.path.join(out, name + ".sol")
        verdict, said = "none", ""
        if run["exit_code"] != "0":
            verdict, said = "failed", f"exit code {run['exit_code']}"
        elif os.path.exists(answer):
            program = mps.read_mps(os.path.join(library, row["file"]))
            try:
                verdict, said = judged(program, mps.read_solution(answer, program.cost), known[name])
            except (ValueError, IndexError) as error:
                verdict, said = "wrong", f"cannot be read: {error}"
        seconds = float(run["seconds"]) if verdict == "proven" else float(run["limit_s"])
        cells[row["class"], row["formulation"]].append((verdict, seconds))
        if said:
            notes.append((verdict, f"{name}: {said}"))
    print(f"{'class':<6} {'formulation':<12} {'programs':>8} {'proven':>7} {'feasible':>9} {'none':>5} {'failed':>7} {'wrong':>6} {'mean s':>8}")
    for (kind, formulation), cell in sorted(cells.items()):
        count = [sum(verdict == wanted for verdict, _ in cell) for wanted in ("proven", "feasible", "none", "failed", "wrong")]
        mean = math.exp(math.fsum(math.log(seconds + SHIFT_S) for _, seconds in cell) / len(cell)) - SHIFT_S
        print(f"{kind:<6} {formulation:<12} {len(cell):>8} {count[0]:>7} {count[1]:>9} {count[2]:>5} {count[3]:>7} {count[4]:>6} {mean:>8.3f}")
    for verdict, note in notes:
        print(f"{verdict}: {note}")
    return 1 if any(verdict == "wrong" for verdict, _ in notes) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
