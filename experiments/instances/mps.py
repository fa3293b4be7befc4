"""Programs and solution files, as `conelane instances` and solvers write them. No package is needed."""

import gzip
import math
import re
from dataclasses import dataclass, field


@dataclass
class Program:
    """A minimisation. Rows and columns by name, in the order of the file."""
    cost: dict = field(default_factory=dict)      # column -> coefficient
    integer: set = field(default_factory=set)     # columns
    bounds: dict = field(default_factory=dict)    # column -> (lower, upper)
    rows: dict = field(default_factory=dict)      # row -> (lower, upper)
    entries: dict = field(default_factory=dict)   # row -> [(column, coefficient)]


def read_mps(path):
    """A free-format MPS file, packed by gzip where its name says so."""
    program, sense, section, integer = Program(), {}, "", False
    opened = gzip.open if str(path).endswith(".gz") else open
    with opened(path, "rt", encoding="ascii") as lines:
        for line in lines:
            word = line.split()
            if not word or line[0] == "*":
                continue
            if line[0] != " ":
                section = word[0]
            elif section == "ROWS":
                sense[word[1]] = word[0]
                if word[0] != "N":
                    low, high = {"L": (-math.inf, 0.0), "G": (0.0, math.inf), "E": (0.0, 0.0)}[word[0]]
                    program.rows[word[1]], program.entries[word[1]] = (low, high), []
            elif section == "COLUMNS" and word[1] == "'MARKER'":
                integer = word[2] == "'INTORG'"
            elif section == "COLUMNS":
                if word[0] not in program.cost:
                    program.cost[word[0]] = 0.0
                    program.bounds[word[0]] = (0.0, math.inf)
                    if integer:
                        program.integer.add(word[0])
                for row, value in zip(word[1::2], word[2::2]):
                    if sense[row] == "N":
                        program.cost[word[0]] = float(value)
                    else:
                        program.entries[row].append((word[0], float(value)))
            elif section == "RHS":
                for row, value in zip(word[1::2], word[2::2]) if len(word) % 2 else zip(word[0::2], word[1::2]):
                    if sense[row] != "N":
                        program.rows[row] = {"L": (-math.inf, float(value)), "G": (float(value), math.inf),
                                             "E": (float(value), float(value))}[sense[row]]
            elif section == "RANGES":
                row, value = word[-2], float(word[-1])
                low, high = program.rows[row]
                program.rows[row] = (high - abs(value), high) if sense[row] == "L" else (low, low + abs(value))
            elif section == "BOUNDS":
                kind, column = word[0], word[2]
                low, high = program.bounds[column]
                value = float(word[3]) if len(word) > 3 else 0.0
                program.bounds[column] = {"LO": (value, high), "UP": (low, value), "FX": (value, value), "BV": (0.0, 1.0),
                                          "FR": (-math.inf, math.inf), "MI": (-math.inf, high), "PL": (low, math.inf)}[kind]
    return program


@dataclass
class Solution:
    status: str = "unknown"     # optimal, feasible, infeasible, unknown
    objective: float | None = None
    bound: float | None = None
    values: dict = field(default_factory=dict)   # column -> value; columns not named are 0


_NUMBER = r"[-+]?(\d|\.\d|inf|nan)"
_STATUS = [("infeasible", "infeasible"), ("gap", "feasible"), ("optimal", "optimal"), ("stopped", "feasible"), ("feasible", "feasible"),
           ("limit", "feasible")]


def _status_of(text):
    return next((status for word, status in _STATUS if word in text.lower()), "unknown")


def is_same(a, b, tolerance=1e-6):
    """Whether two objectives are the same, within the tolerance of the larger one or of 1."""
    return math.isclose(a, b, rel_tol=tolerance, abs_tol=tolerance)


def _set(solution, column, value):
    if column in solution.values:
        raise ValueError(f"{column} is there twice")
    solution.values[column] = float(value)


def read_solution(path, columns, rows=()):
    """A file of CBC, GLPK, HiGHS, SCIP, MIPLIB or Gurobi, told by its lines. `columns` are the names in the order of the program, for
    GLPK, which numbers them; CBC may list `rows` too. Lines `=status=`, `=bound=`, `=obj=` and `=infeas=` say what a format cannot. Raises
    ValueError for a column that is there twice and where two lines contradict each other."""
    with open(path, encoding="utf-8") as stream:
        lines = [line.rstrip("\n") for line in stream]
    solution, names, body = Solution(), list(columns), lines
    head = lines[0] if lines else ""
    is_named = True  # the format says its status
    if found := re.match(r"((?:Optimal|Infeasible|Integer infeasible|Stopped|Unbounded).*) - objective value (\S+)", head):  # CBC
        solution.status, solution.objective, body = _status_of(found[1]), float(found[2]), []
        points = "" if "no integer solution" in head else lines[1:]  # the relaxation's point is no answer
        for line in points:
            word = line.replace("**", " ").split()
            if len(word) >= 3 and word[0].isdigit() and word[1] not in rows:
                _set(solution, word[1], word[2])
    elif head.startswith("c ") and any(line.startswith("s ") for line in lines):  # GLPK
        body = []
        for line in lines:
            word = line.split()
            if word[:1] == ["s"]:
                solution.status = {"o": "optimal", "f": "feasible", "n": "infeasible"}.get(word[4], "unknown")
                solution.objective = float(word[5])
            elif word[:1] == ["j"]:
                _set(solution, names[int(word[1]) - 1], word[2])
    elif head.startswith("Model status"):  # HiGHS
        solution.status, body, inside = _status_of(lines[1]), [], False
        for line in lines[2:]:
            word = line.split()
            if line.startswith("Objective "):
                solution.objective = float(word[1])
            elif line.startswith("# "):
                inside = line.startswith("# Columns")
                if line.startswith("# Dual"):
                    break
            elif inside and len(word) == 2:
                _set(solution, *word)
    elif head.startswith("solution status:"):  # SCIP
        solution.status = _status_of(head)
    else:
        is_named = False
    for line in body:
        word = line.split()
        if found := re.match(r"(?:# Objective value =|objective value:)\s*(\S+)", line):
            solution.objective = float(found[1])
        elif len(word) >= 2 and word[0][0] not in "#=" and re.match(_NUMBER, word[1]):
            _set(solution, *word[:2])
    for line in lines:
        word = line.split()
        if len(word) >= 2 and word[0] == "=status=":
            if is_named and word[1] == "optimal" and solution.status != "optimal":
                raise ValueError(f"=status= says optimal, the head of the file {solution.status}")
            solution.status = word[1]
        elif len(word) >= 2 and word[0] == "=bound=":
            solution.bound = float(word[1])
        elif len(word) >= 2 and word[0] == "=obj=":
            if solution.objective is not None and not is_same(float(word[1]), solution.objective):
                raise ValueError(f"=obj= says {word[1]}, the head of the file {solution.objective:.9g}")
            solution.objective = float(word[1])
        elif word[:1] == ["=infeas="]:
            solution.status = "infeasible"
    if solution.status == "unknown" and (solution.values or solution.objective is not None):
        solution.status = "feasible"
    return solution


def violation(program, values, tolerance=1e-6):
    """What a point breaks, in words; None if nothing. Rows, bounds and integrality within the tolerance."""
    for column, value in values.items():
        if column not in program.cost:
            return f"there is no column {column}"
        if not math.isfinite(value):
            return f"{column} is {value}"
        low, high = program.bounds[column]
        if not low - tolerance <= value <= high + tolerance:
            return f"{column} is {value:g}, outside {low:g} to {high:g}"
        if column in program.integer and abs(value - round(value)) > tolerance:
            return f"{column} is {value:g}, not a whole number"
    for column, (low, high) in program.bounds.items():
        if column not in values and not low <= 0.0 <= high:
            return f"{column} is 0, outside {low:g} to {high:g}"
    for row, (low, high) in program.rows.items():
        value = math.fsum(coefficient * values.get(column, 0.0) for column, coefficient in program.entries[row])
        if not low - tolerance <= value <= high + tolerance:
            return f"row {row} is {value:g}, outside {low:g} to {high:g}"
    return None


def objective_of(program, values):
    return math.fsum(program.cost[column] * value for column, value in values.items())
