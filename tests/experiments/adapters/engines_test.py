"""engines_test.py ROOT PROGRAM: each engine of experiments/adapters that is installed finds the optima of path-pair, with rows on demand, with all rows and
from a start; one that is missing is skipped by name. Mosek, which needs a licence, gives a recorded answer."""

import json
import os
import subprocess
import sys
import tempfile
import types
import unittest
from unittest import mock

ROOT, PROGRAM = sys.argv.pop(1), sys.argv.pop(1)
ADAPTERS = os.path.join(ROOT, "experiments", "adapters")
FETCHED = os.path.join(ROOT, "build", "solvers", "bin", "python")
sys.dont_write_bytecode = True
sys.path.insert(0, ADAPTERS)

import engines  # noqa: E402
import frame  # noqa: E402

# A lane of four cones and, far away, a square: as a cycle it pays, so the answer violates a row (5) that is added on demand.
LANE, SQUARE = [(4, 1.5), (7.2, 1.5), (4, -1.5), (7.2, -1.5)], [(30, 10), (33.2, 10), (33.2, 13.2), (30, 13.2)]
SCENES = [LANE + [(x + shift, y - shift) for x, y in SQUARE] for shift in (0, 3, 9)] + [LANE, LANE[:3]]
PARAMETERS = {"d_e": 3.2, "d_t": 1.7, "theta_e": 3.141592653589793, "theta_t": 2.0, "w_s": 0.4, "w_t": 0.5, "w_p": 1.2, "w_b": 1.0, "d_min": 0.0, "d_h": 6.0,
              "theta_heading": 1.2, "d_near": 6.0, "d_max": 6.5, "s_crit": 2.5, "t_crit": 100.0}
# A setting of each engine that ends no search early.
SETTINGS = {"highspy": "presolve=off,mip_heuristic_effort=0.1", "scip": "separating=off,lp/solvefreq=1", "cp-sat": "linearization_level=2", "cbc-today": "cuts=off",
            "glpsol": "mostf", "symphony": "j=0", "lp-solve": "BB", "gurobi": "Cuts=0", "xpress": "cutstrategy=0", "cplex": "mip.strategy.probe=1",
            "copt": "CutLevel=0"}
TWO = """NAME two FREE
ROWS
 N cost
 L both
COLUMNS
 MARKER 'MARKER' 'INTORG'
 x cost -1 both 1
 y cost -2 both 1
 MARKER 'MARKER' 'INTEND'
RHS
 RHS both 1
BOUNDS
 UP BND x 1
 UP BND y 1
ENDATA
"""


def lines_of(path):
    with open(path, encoding="utf-8") as stream:
        return [json.loads(line) for line in stream]


def python_of(name):
    """The interpreter that has what the engine needs; None if nothing has."""
    for python in (FETCHED, sys.executable):
        if os.path.exists(python):
            listed = subprocess.run([python, "-B", os.path.join(ADAPTERS, "engines.py"), "--list"], capture_output=True, text=True, check=True).stdout
            if f"\n{name} " in "\n" + listed and f"{name:11} installed" in listed:
                return python
    return None


class Engines(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()  # pylint: disable=consider-using-with
        with open(cls.path("s.scenes.jsonl"), "w", encoding="utf-8") as stream:
            for number, cones in enumerate(SCENES):
                stream.write(json.dumps({"id": str(number), "pose": {"x": 0.0, "y": 0.0, "yaw": 0.0},
                                         "cones": [{"id": at, "x": x, "y": y} for at, (x, y) in enumerate(cones)]}) + "\n")
        with open(cls.path("parameters.json"), "w", encoding="utf-8") as stream:
            json.dump(PARAMETERS, stream)
        cls.exact = cls.solved("path-pair")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    @classmethod
    def run_program(cls, *words):
        done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=False)
        if done.returncode:
            raise AssertionError(done.stderr)

    @classmethod
    def solved(cls, solver, *options):
        cls.run_program("solve", "--solver", solver, "--scenes", cls.path("s.scenes.jsonl"), "--params", cls.path("parameters.json"),
                        "--time-limit", "120000", "--out", cls.path("o.solutions.jsonl"), *options)
        return lines_of(cls.path("o.solutions.jsonl"))

    def check(self, name):
        python = python_of(name)
        if python is None:
            self.skipTest(f"{name} is not installed: see experiments/solvers/install")
        if name == "mosek" and not os.path.exists(os.environ.get("MOSEKLM_LICENSE_FILE", os.path.expanduser("~/mosek/mosek.lic"))):
            self.skipTest("Mosek has no licence here")
        self.assertEqual([record["status"] for record in self.exact], ["optimal"] * 4 + ["infeasible"])
        command = f"exec:{name}={python} -B {os.path.join(ADAPTERS, 'engines.py')} {name}"
        for settings, *options in (("",), (":" + SETTINGS.get(name, ""), "--all-rows", "--warm-start")):
            for record, exact in zip(self.solved(command + settings, *options), self.exact, strict=True):
                self.assertEqual(record["status"], exact["status"], f"{settings} {options} {record}")
                self.assertAlmostEqual(record.get("objective", 0.0), exact.get("objective", 0.0), delta=1e-6)
        if name in ("highspy", "scip", "cp-sat", "gurobi", "xpress", "cplex", "copt"):  # programs of their own say it in their logs
            with self.assertRaisesRegex(AssertionError, "5 of 5 answers are errors"):
                self.solved(command + ":no_such_setting=1")

    def test_settings_follow_the_name(self):
        self.assertEqual(frame.named("scip"), ("scip", {}))
        self.assertEqual(frame.named("cbc:cuts=off,BB,depth=-1,gap=0.5"), ("cbc", {"cuts": "off", "BB": "", "depth": -1, "gap": 0.5}))
        asked = frame.Question("p", "s", settings={"cuts": "off", "BB": "", "depth": 0})
        self.assertEqual(asked.arguments("-"), ["-cuts", "off", "-BB", "-depth", "0"])

    def ask(self, engine, **asked):
        with open(self.path("two.mps"), "w", encoding="ascii") as stream:
            stream.write(TWO)
        question = frame.Question(self.path("two.mps"), self.path("two.sol"), **asked)
        return frame.answered(engine, question)

    def test_mosek_by_a_recorded_answer(self):
        """What optimize left behind for this program, as its manual describes it; all else of the interface is a record of the calls."""
        task = mock.MagicMock()
        task.__enter__.return_value = task
        task.getsolsta.return_value, task.getprosta.return_value = "integer_optimal", "prim_feas"
        task.getnumvar.return_value, task.getvarname.side_effect = 2, ["x", "y"].__getitem__
        task.getxx.return_value, task.getdouinf.return_value, task.getintinf.return_value = [0.0, 0.9999999], -2.0, 1
        env = mock.MagicMock()
        env.__enter__.return_value = env
        env.Task.return_value = task
        library = types.SimpleNamespace(
            Env=mock.Mock(return_value=env, getversion=lambda: (11, 2, 7)), solsta=types.SimpleNamespace(integer_optimal="integer_optimal", prim_feas="prim_feas"),
            prosta=types.SimpleNamespace(prim_infeas="prim_infeas"), soltype=mock.Mock(), iparam=mock.Mock(), dparam=mock.Mock(), dinfitem=mock.Mock(),
            iinfitem=mock.Mock())
        with mock.patch.dict(sys.modules, {"mosek": library}):
            told = self.ask(engines.mosek)
            self.assertEqual({key: told[key] for key in ("status", "bound", "nodes", "solver")},
                             {"status": "optimal", "bound": -2.0, "nodes": 1, "solver": "Mosek 11.2.7"})
            with open(self.path("two.sol"), encoding="ascii") as stream:
                self.assertEqual(stream.read(), "=obj= -2.0\ny 1.0\n")
            task.getsolsta.return_value, task.getprosta.return_value = "unknown", "prim_infeas"
            self.assertEqual(self.ask(engines.mosek)["status"], "infeasible")
            task.optimize.side_effect = RuntimeError("License cannot be located")
            self.assertEqual(self.ask(engines.mosek), {"status": "error", "message": "RuntimeError: License cannot be located"})

    def test_a_claim_without_a_point_is_an_error(self):
        self.assertEqual(self.ask(lambda _: frame.Answer("optimal"))["status"], "error")
        self.assertEqual(self.ask(lambda _: frame.Answer("time limit", bound=-1e20)).keys(), {"ms", "solver", "status"})
        self.assertEqual(self.ask(lambda _: frame.Answer("time limit", {"y": 1.0}))["status"], "feasible")

    def test_cycles_are_found(self):
        self.assertEqual(engines.cycles([(0, 1), (1, 2), (4, 5), (5, 6), (4, 6), (7, 8)]), [{4, 5, 6}])


for one in engines.ENGINES:
    setattr(Engines, f"test_{one.replace('-', '_')}_finds_the_optima", lambda self, name=one: self.check(name))

if __name__ == "__main__":
    unittest.main(verbosity=2)
