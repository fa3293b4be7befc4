"""HiGHS, as scipy has it (Debian: python3-scipy), as a solver from outside:

    conelane solve --solver "exec:highs=/usr/bin/python3 experiments/adapters/highs_scipy.py" ...

The program stays running, because scipy takes a second to load. One thread; scipy passes on no seed and no start.
`highs_scipy.py {mps} {sol} {limit_s}` answers one program and ends."""

import json
import sys
import time

import numpy as np
import scipy
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array


def read_mps(path):
    """A free-format MPS file as conelane writes it: cost, integrality, bounds, matrix, row bounds, names."""
    section, integer, rows, columns, entries = "", False, {}, {}, []
    sense, right, ranges, integrality, cost, lower, upper = [], {}, {}, [], {}, {}, {}
    for line in open(path, encoding="ascii"):
        word = line.split()
        if line[0] != " ":
            section = word[0]
        elif section == "ROWS" and word[0] != "N":
            rows[word[1]] = len(rows)
            sense.append(word[0])
        elif section == "COLUMNS" and word[1] == "'MARKER'":
            integer = word[2] == "'INTORG'"
        elif section == "COLUMNS":
            if word[0] not in columns:
                columns[word[0]] = len(columns)
                integrality.append(integer)
            if word[1] in rows:
                entries.append((rows[word[1]], columns[word[0]], float(word[2])))
            elif word[1] == "cost":
                cost[columns[word[0]]] = float(word[2])
        elif section == "RHS":
            right[rows[word[1]]] = float(word[2])
        elif section == "RANGES":
            ranges[rows[word[1]]] = float(word[2])
        elif section == "BOUNDS":
            (lower if word[0] == "LO" else upper)[columns[word[2]]] = float(word[3])
    side = np.array([right.get(r, 0.0) for r in range(len(rows))])
    low = np.array([side[r] - ranges[r] if r in ranges else -np.inf if s == "L" else side[r]
                    for r, s in enumerate(sense)])
    high = np.array([np.inf if s == "G" else side[r] for r, s in enumerate(sense)])
    row, column, value = zip(*entries)
    matrix = csr_array((value, (row, column)), shape=(len(rows), len(columns)))
    of_columns = [np.array([some.get(c, 0.0) for c in range(len(columns))]) for some in (cost, lower, upper)]
    return of_columns, np.array(integrality, dtype=int), LinearConstraint(matrix, low, high), list(columns)


def answer(question):
    (cost, lower, upper), integrality, constraints, names = read_mps(question["program"])
    start = time.perf_counter()
    result = milp(cost, integrality=integrality, bounds=Bounds(lower, upper), constraints=constraints,
                  options={"mip_rel_gap": 0.0, "time_limit": question["time_limit_ms"] / 1000.0})
    told = {"ms": 1000.0 * (time.perf_counter() - start), "solver": f"HiGHS of scipy {scipy.__version__}"}
    if getattr(result, "mip_dual_bound", None) is not None and np.isfinite(result.mip_dual_bound):
        told["bound"] = result.mip_dual_bound
    if getattr(result, "mip_node_count", None) is not None:
        told["nodes"] = max(0, int(result.mip_node_count))
    if result.x is not None:
        with open(question["solution"], "w", encoding="ascii") as file:
            file.write(f"=obj= {result.fun!r}\n")
            file.writelines(f"{name} {float(value)!r}\n" for name, value in zip(names, result.x) if value != 0.0)
        return told | {"status": "optimal" if result.status == 0 else "feasible"}
    if result.status == 2:
        return {key: told[key] for key in ("ms", "solver")} | {"status": "infeasible"}
    return told | ({"status": "unknown"} if result.status == 1 else {"status": "error", "message": result.message})


def answer_once(program, solution, limit_s):
    told = answer({"program": program, "solution": solution, "time_limit_ms": 1000.0 * float(limit_s)})
    with open(solution, "a", encoding="ascii") as file:
        file.writelines(f"={key}= {told[key]}\n" for key in ("status", "bound", "nodes", "ms", "solver") if key in told)


if len(sys.argv) > 1:
    answer_once(*sys.argv[1:])
else:
    for request in sys.stdin:
        print(json.dumps(answer(json.loads(request))), flush=True)
