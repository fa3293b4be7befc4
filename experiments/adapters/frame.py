"""What all engines of engines.py share: the conversation with conelane (docs/from-outside.md), the clock, the solution file and the verdict."""

import dataclasses
import importlib.util
import json
import math
import os
import shutil
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "instances"))
import mps  # noqa: E402

GRACE_S = 0.5  # a program of its own is ended so long after its limit
LEAST_S = 1e-3  # some engines take a limit of 0 for none
INTEGRALITY = 1e-5


@dataclasses.dataclass
class Question:
    program: str   # file, free MPS
    solution: str  # file to write
    whole_limit_s: float = 1e6  # reading and building included
    gap: float = 1e-9
    threads: int = 1
    seed: int = 0
    cutoff: float | None = None  # only points with a lower objective are of use
    ms: float = 0.0  # time of the engine alone, without reading and building
    asked_s: float = dataclasses.field(default_factory=time.perf_counter)

    @property
    def limit_s(self):
        """What is left: to be read when the program is built."""
        return max(LEAST_S, self.whole_limit_s - (time.perf_counter() - self.asked_s))

    def read(self):
        return mps.read_mps(self.program)

    def clock(self, solve, *arguments):
        start = time.perf_counter()
        try:
            return solve(*arguments)
        finally:
            self.ms += 1000.0 * (time.perf_counter() - start)

    def run(self, *command):
        """Standard output of a program of its own. A program that ignores its limit is ended, and what it has printed counts."""
        try:
            done = self.clock(lambda: subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False,
                                                     timeout=self.limit_s + GRACE_S, cwd=os.path.dirname(self.solution) or None))
        except subprocess.TimeoutExpired as late:
            return (late.stdout or b"").decode("utf-8", "replace")
        if done.returncode < 0:
            raise RuntimeError(f"{command[0]} ended by signal {-done.returncode}")
        return done.stdout


@dataclasses.dataclass
class Answer:
    """`claim`: optimal or infeasible is a proof, anything else is none. `values`: by column, zeros may be left out; None without a point."""
    claim: str
    values: dict | None = None
    bound: float | None = None
    nodes: int | None = None
    solver: str = ""


def whole(values, integer):
    """Values of integer columns are rounded where they are whole within the tolerance of any engine; conelane checks rows and objective of
    the rounded point."""
    return {name: float(round(value)) if name in integer and abs(value - round(value)) <= INTEGRALITY else float(value)
            for name, value in values.items()}


def verdict(question, answer):
    """The line of the answer; writes the solution file if there is a point."""
    told = {"ms": question.ms, "solver": answer.solver}
    if answer.claim == "infeasible":
        return told | {"status": "infeasible"}
    if answer.nodes is not None:
        told["nodes"] = max(0, int(answer.nodes))
    if answer.bound is not None and abs(answer.bound) < 1e19:
        told["bound"] = float(answer.bound)
    if answer.values is None:
        return told | {"status": "error", "message": "an optimum without a point"} if answer.claim == "optimal" else told | {"status": "unknown"}
    program = question.read()
    values = whole(answer.values, program.integer)
    with open(question.solution, "w", encoding="ascii") as file:
        file.write(f"=obj= {mps.objective_of(program, values)!r}\n")
        file.writelines(f"{name} {value!r}\n" for name, value in values.items() if value != 0.0)
    return told | {"status": "optimal" if answer.claim == "optimal" else "feasible"}


def answered(engine, question):
    try:
        return verdict(question, engine(question))
    except Exception as failure:  # pylint: disable=broad-except  # an engine may raise anything, and the next program is another
        return {"status": "error", "message": f"{type(failure).__name__}: {failure}".splitlines()[0]}


def is_there(needs):
    """Whether one of these is installed, packages of this interpreter or programs."""
    return any(importlib.util.find_spec(one) is not None or shutil.which(one) is not None for one in needs)


def serve(engines, words):
    """`engines`: a function and what it needs one of, by name. `words`: NAME, or NAME PROGRAM SOLUTION [LIMIT_S [GAP [THREADS [SEED]]]] for
    one program; or --list."""
    if words == ["--list"]:
        for name, (_, needs) in engines.items():
            print(f"{name:11} {'installed' if is_there(needs) else 'missing: ' + ' or '.join(needs)}")
        return
    if not words or words[0] not in engines:
        raise SystemExit(f"engines.py: name one of {' '.join(engines)}")
    engine, needs = engines[words[0]]
    if not is_there(needs):
        raise SystemExit(f"engines.py: {words[0]} needs {' or '.join(needs)}: see experiments/solvers/install")
    # Some libraries print to the standard output, which belongs to the answers.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    for package in filter(importlib.util.find_spec, needs):  # before the first question: loading takes seconds
        importlib.import_module(package)
    if len(words) > 1:
        kinds = (str, str, float, float, int, int)
        question = Question(*(kind(word) for kind, word in zip(kinds, words[1:])))
        told = answered(engine, question)
        if told["status"] == "error":
            raise SystemExit(told["message"])
        with open(question.solution, "a", encoding="ascii") as file:
            file.writelines(f"={key}= {value}\n" for key, value in told.items() if value != "")
        return
    for line in sys.stdin:
        asked = json.loads(line)
        question = Question(asked["program"], asked["solution"], asked["time_limit_ms"] / 1000.0, asked["absolute_gap"],
                            asked["threads"], asked["seed"], asked.get("cutoff"))
        told = answered(engine, question)
        print(json.dumps({key: value for key, value in told.items() if not (isinstance(value, float) and math.isnan(value))}),
              file=answers, flush=True)
