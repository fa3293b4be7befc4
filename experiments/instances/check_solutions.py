"""Checks what a solver answered to the programs of a library, after run_solver.py.

    check_solutions.py LIBRARY OUT

Each point is tried in its program: rows, bounds and whole numbers within 1e-6, and its objective is computed again. A claimed optimum or
infeasibility is proven if the library's own proof says the same within 1e-6 of its size (`=opt=`, `=inf=`, or a `=bestdual=` that the
point meets), wrong if a point or a proof of the library contradicts it, and otherwise unverified. The table has for each class how many programs
are proven, unverified, only feasible, without a point, failed and wrong, and the shifted geometric mean (10 ms) of the times, with what is not
proven at the limit. Better points of open programs are listed below it. Exit code 1 if an answer is wrong.
"""

import csv
import math
import os
import sys
from collections import defaultdict

import mps
from run_solver import index_of, name_of

SHIFT_S = 0.01


def known_values(library):
    """(optimal value, best value, whether it is infeasible) by name, from conelane.solu."""
    known = defaultdict(dict)
    with open(os.path.join(library, "conelane.solu"), encoding="utf-8") as stream:
        for line in stream:
            mark, name, *value = line.split()
            known[name][mark] = float(value[0]) if value else None
    return known


VERDICTS = ("proven", "unverified", "feasible", "none", "failed", "wrong")


def judged(program, solution, known):
    """(one of VERDICTS, what to say)"""
    best = known.get("=opt=", known.get("=best="))
    bound = known.get("=opt=", known.get("=bestdual="))
    if solution.status == "infeasible":
        if "=inf=" in known:
            return "proven", ""
        return ("wrong", f"claimed to be infeasible, has a point of {best:.9g}") if best is not None else ("unverified", "claimed to be infeasible")
    # A claimed optimum without values is the point where all columns are 0.
    if solution.status != "optimal" and not (solution.status == "feasible" and solution.values):
        return "none", ""
    if broken := mps.violation(program, solution.values):
        return "wrong", broken
    value = mps.objective_of(program, solution.values)

    def is_below(a, b):
        return a < b and not mps.is_same(a, b)

    if solution.objective is not None and not mps.is_same(value, solution.objective):
        return "wrong", f"claims an objective of {solution.objective:.9g}, its point has {value:.9g}"
    if solution.bound is not None and is_below(value, solution.bound):
        return "wrong", f"claims a bound of {solution.bound:.9g}, its point has {value:.9g}"
    if "=inf=" in known:
        return "wrong", "has a point, known to be infeasible"
    if bound is not None and is_below(value, bound):
        return "wrong", f"its point of {value:.9g} is better than the bound of the library, {bound:.9g}: the library is wrong"
    is_better = best is None or is_below(value, best)
    said = f"a better point: {value:.9g}, best known {'none' if best is None else format(best, '.9g')}" if is_better else ""
    if solution.status != "optimal":
        return "feasible", said
    if best is not None and is_below(best, value):
        return "wrong", f"claims {value:.9g} to be the optimum, there is a point of {best:.9g}"
    if bound is not None and mps.is_same(value, bound):
        return "proven", ""
    return "unverified", said or f"claims {value:.9g} to be the optimum, which the library does not know"


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
                verdict, said = judged(program, mps.read_solution(answer, program.cost, program.rows), known[name])
            except (ValueError, IndexError) as error:
                verdict, said = "wrong", f"cannot be read: {error}"
        seconds = float(run["seconds"]) if verdict == "proven" else float(run["limit_s"])
        cells[row["class"], row["formulation"]].append((verdict, seconds))
        if said:
            notes.append((verdict, f"{name}: {said}"))
    print(f"{'class':<6} {'formulation':<12} {'programs':>8}" + "".join(f" {verdict:>10}" for verdict in VERDICTS) + f" {'mean s':>8}")
    for (kind, formulation), cell in sorted(cells.items()):
        counts = "".join(f" {sum(verdict == wanted for verdict, _ in cell):>10}" for wanted in VERDICTS)
        mean = math.exp(math.fsum(math.log(seconds + SHIFT_S) for _, seconds in cell) / len(cell)) - SHIFT_S
        print(f"{kind:<6} {formulation:<12} {len(cell):>8}{counts} {mean:>8.3f}")
    for verdict, note in notes:
        print(f"{verdict}: {note}")
    return 1 if any(verdict == "wrong" for verdict, _ in notes) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
