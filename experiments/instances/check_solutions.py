"""Checks what solvers answered to the programs of a library, after run_solver.py.

    check_solutions.py [--classes] LIBRARY OUT...

OUT is a folder of a solver, which has its name. Each point is tried in its program: rows, bounds and whole numbers within 1e-6, and its objective
is computed again. A claimed optimum or infeasibility is proven if the library's own proof says the same within 1e-6 of its size (`=opt=`, `=inf=`,
or a `=bestdual=` that the point meets), agreed if only another of the solvers claims the same, wrong if a point or a proof of the library or of
another solver contradicts it, and otherwise unverified. A bound above a point of the library is wrong, too. The table has for each solver and class
how many programs are proven, agreed, unverified, only feasible, without a point, failed and wrong, and the shifted geometric mean (10 ms) of the
times, with what is not proven at the limit. Better points of open programs are listed below it. Exit code 1 if an answer is wrong. With --classes,
the fastest proof by one of the solvers enters the index, if it is faster than the one there.
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


VERDICTS = ("proven", "agreed", "unverified", "feasible", "none", "failed", "wrong")


def judged(program, solution, known):
    """(one of VERDICTS, what to say)"""
    best = known.get("=opt=", known.get("=best="))
    bound = known.get("=opt=", known.get("=bestdual="))

    def is_below(a, b):
        return a < b and not mps.is_same(a, b)

    if solution.status == "infeasible":
        if "=inf=" in known:
            return "proven", ""
        return ("wrong", f"claimed to be infeasible, has a point of {best:.9g}") if best is not None else ("unverified", "claimed to be infeasible")
    if solution.bound is not None and best is not None and is_below(best, solution.bound):
        return "wrong", f"claims a bound of {solution.bound:.9g}, there is a point of {best:.9g}"
    # A claimed optimum without values is the point where all columns are 0.
    if solution.status != "optimal" and not (solution.status == "feasible" and solution.values):
        return "none", ""
    if broken := mps.violation(program, solution.values):
        return "wrong", broken
    value = mps.objective_of(program, solution.values)
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


EASY_MS = 1000.0


def answers_of(library, out, known):
    """[verdict, what to say, seconds, limit, claimed or found value] of each program that was run; the value is infinite for infeasibility."""
    with open(os.path.join(out, "runs.csv"), newline="", encoding="utf-8") as stream:
        runs = {row["name"]: row for row in csv.DictReader(stream)}
    answers = {}
    for row in index_of(library):
        name = name_of(row)
        if name not in runs:
            continue
        run = runs[name]
        path = os.path.join(out, name + ".sol")
        verdict, said, value = "none", "", None
        if run["exit_code"] != "0":
            verdict, said = "failed", f"exit code {run['exit_code']}"
        elif os.path.exists(path):
            program = mps.read_mps(os.path.join(library, row["file"]))
            try:
                solution = mps.read_solution(path, program.cost, program.rows)
                verdict, said = judged(program, solution, known[name])
                value = math.inf if solution.status == "infeasible" else mps.objective_of(program, solution.values)
            except (ValueError, IndexError, KeyError) as error:
                verdict, said = "wrong", said or f"cannot be read: {error}"
        answers[name] = [verdict, said, float(run["seconds"]), float(run["limit_s"]), value]
    return answers


def compare(answers):
    """Changes the verdicts on claims that the library does not know, by what the other solvers say of the same program."""
    usable = [answer for answer in answers if answer[0] in ("proven", "unverified", "feasible")]
    best = min((answer[4] for answer in usable), default=math.inf)
    claims = [answer for answer in usable if answer[0] == "unverified"]
    agreed = [answer for answer in claims if answer[4] == best or (answer[4] < math.inf and mps.is_same(answer[4], best))]
    for answer in claims:
        if answer not in agreed:
            answer[:2] = "wrong", f"claims {answer[4]:.9g} to be the optimum, another solver has a point of {best:.9g}"
        elif len(agreed) > 1:
            answer[0] = "agreed"  # perhaps two runs of one engine: no proof


def write_classes(library, of_solver):
    rows = index_of(library)
    for row in rows:
        proofs = [(float(row["first_ms"]), row["first_by"])] if row["first_by"] else []
        proofs += [(1000.0 * answers[name_of(row)][2], solver) for solver, answers in of_solver.items()
                   if answers.get(name_of(row), [""])[0] == "proven"]
        if proofs:
            time_ms, row["first_by"] = min(proofs)
            row["first_ms"], row["class"] = f"{time_ms:.3f}", "easy" if time_ms <= EASY_MS else "hard"
    path = os.path.join(library, "index.csv")
    with open(path + ".part", "w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    os.replace(path + ".part", path)


def main(arguments):
    with_classes = arguments[:1] == ["--classes"]
    library, *outs = arguments[with_classes:] or [""]
    if not outs:
        print(__doc__, file=sys.stderr)
        return 2
    for folder, file, maker in [(library, "index.csv", "`conelane instances`"), *((out, "runs.csv", "run_solver.py") for out in outs)]:
        if not os.path.exists(os.path.join(folder, file)):
            print(f"check_solutions.py: {folder} holds no {file}: {maker} makes it", file=sys.stderr)
            return 2
    known = known_values(library)
    of_solver = {os.path.basename(os.path.normpath(out)): answers_of(library, out, known) for out in outs}
    cells, notes = defaultdict(list), []
    for row in index_of(library):
        name = name_of(row)
        compare([answers[name] for answers in of_solver.values() if name in answers])
        for solver, answers in of_solver.items():
            if name in answers:
                verdict, said, seconds, limit_s, _ = answers[name]
                cells[solver, row["class"], row["formulation"]].append((verdict, seconds if verdict == "proven" else limit_s))
                notes += [(verdict, f"{name}: {solver}: {said}")] if said else []
    print(f"{'solver':<16} {'class':<6} {'formulation':<12} {'programs':>8}" + "".join(f" {verdict:>10}" for verdict in VERDICTS) + f" {'mean s':>8}")
    for (solver, kind, formulation), cell in sorted(cells.items()):
        counts = "".join(f" {sum(verdict == wanted for verdict, _ in cell):>10}" for wanted in VERDICTS)
        mean = math.exp(math.fsum(math.log(seconds + SHIFT_S) for _, seconds in cell) / len(cell)) - SHIFT_S
        print(f"{solver:<16} {kind:<6} {formulation:<12} {len(cell):>8}{counts} {mean:>8.3f}")
    for verdict, note in notes:
        print(f"{verdict}: {note}")
    if with_classes:
        write_classes(library, of_solver)
    return 1 if any(answer[0] == "wrong" for answers in of_solver.values() for answer in answers.values()) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
