"""library_scripts_test.py ROOT PROGRAM: run_solver.py and check_solutions.py on a small library, with right answers, and with wrong ones of each kind."""

import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT, PROGRAM = sys.argv.pop(1), sys.argv.pop(1)
SCRIPTS = os.path.join(ROOT, "experiments", "instances")
sys.dont_write_bytecode = True
sys.path.insert(0, SCRIPTS)

import check_solutions  # noqa: E402
import mps  # noqa: E402

PROGRAM_TEXT = """NAME two FREE
ROWS
 N cost
 L both
 G one
COLUMNS
 MARKER 'MARKER' 'INTORG'
 x cost -1 both 1
 x one 1
 y cost -2 both 1
 MARKER 'MARKER' 'INTEND'
RHS
 RHS both 1
BOUNDS
 UP BND x 1
 UP BND y 1
ENDATA
"""


def script(name, *arguments):
    return subprocess.run([sys.executable, "-B", os.path.join(SCRIPTS, name), *arguments], capture_output=True, text=True, check=False)


class Scripts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.library = os.path.join(cls.folder, "library")
        subprocess.run([PROGRAM, "instances", "--tracks", "generated:circle", "--fp", "0.3", "--range", "30", "--every", "1000", "--nearest", "12",
                        "--params", "default,shape", "--out", cls.library], check=True, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def checked(self, name, command, *options):
        out = os.path.join(self.folder, name)
        run = script("run_solver.py", self.library, out, "--limit-s", "20", *options, "--", command)
        self.assertEqual(run.returncode, 0, run.stderr)
        return script("check_solutions.py", self.library, out)

    def read(self, reader, text, *arguments):
        """What `reader` makes of a file with this text."""
        path = os.path.join(self.folder, "file")
        with open(path, "w", encoding="ascii") as stream:
            stream.write(text)
        return reader(path, *arguments)

    def test_a_run_takes_no_answer_of_another_one(self):
        out, nothing = (os.path.join(self.folder, name) for name in ("again", "nothing"))
        lie, tight = "echo =infeas= > {sol}", ("--formulation", "tight")
        for name, *arguments, code, said in (
                ("run_solver.py", self.library, out, *tight, "--", lie, 0, "0 of 2 already there, 2 to run"),
                ("run_solver.py", self.library, out, *tight, "--", lie, 0, "2 of 2 already there, 0 to run"),
                ("run_solver.py", self.library, out, *tight, "--", "true", 2, f"again has runs of {lie}: name another folder"),
                ("run_solver.py", self.library, nothing, "--classes", "esy", "--", "true", 2, "there is no class 'esy'"),
                ("run_solver.py", nothing, nothing, "--", "true", 2, "nothing holds no index.csv"),
                ("check_solutions.py", nothing, out, 2, "nothing holds no index.csv"),
                ("check_solutions.py", self.library, nothing, 2, "nothing holds no runs.csv")):
            done = script(name, *arguments)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(said, done.stderr)
        os.remove(os.path.join(out, "runs.csv"))
        self.checked("again", "true", *tight)
        self.assertFalse([name for name in os.listdir(out) if name.endswith(".sol")])

    def test_the_public_library_has_no_part_of_another_name(self):
        out = os.path.join(self.folder, "public")
        done = subprocess.run([os.path.join(SCRIPTS, "public_library"), out, self.folder, "whole", "hole"], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (2, "public_library: there is no part 'hole'\n"))
        self.assertFalse(os.path.exists(out))

    def test_a_solver_with_right_answers_passes(self):
        commands = {"cbc": "cbc {mps} {sol} {limit_s} {gap} {threads} {seed}", "glpsol": "glpsol {mps} {sol} {limit_whole_s}"}
        there = [program for program in commands if shutil.which(program)]
        if not there:
            self.skipTest("there is no cbc and no glpsol")
        for program in there:
            check = self.checked(program, os.path.join(ROOT, "experiments", "adapters", commands[program]), "--formulation", "tight")
            self.assertEqual(check.returncode, 0, check.stdout)
            self.assertRegex(check.stdout, r"easy +tight +2 +2 +0 +0 +0 +0 +0 +0 ")

    def test_the_optimum_of_a_file_is_that_of_its_scene(self):
        """CBC has too little time for an own proof, path-pair has enough: the files have all rows, and CBC's program finds the same optimum."""
        if not shutil.which("cbc"):
            self.skipTest("there is no cbc")
        library, out = os.path.join(self.folder, "short"), os.path.join(self.folder, "cbc_short")
        subprocess.run([PROGRAM, "instances", "--tracks", "generated:hairpins", "--fp", "0.3", "--range", "30", "--every", "200", "--nearest", "16,all",
                        "--seed", "7", "--max-printed-cones", "1", "--time-limit", "20", "--out", library], check=True, capture_output=True)
        rows = check_solutions.index_of(library)
        flows = [row for row in rows if row["rows"] == "flow" and row["proved_by"] == "path-pair"]
        self.assertTrue(flows, [row["first_by"] for row in rows])
        run = script("run_solver.py", library, out, "--limit-s", "60", "--", os.path.join(ROOT, "experiments/adapters/cbc {mps} {sol} {limit_s} {gap} {threads} {seed}"))
        self.assertEqual(run.returncode, 0, run.stderr)
        answers = check_solutions.answers_of(library, out, check_solutions.known_values(library))
        self.assertEqual({answers[check_solutions.name_of(row)][0] for row in flows}, {"proven"}, answers)

    def test_solvers_confirm_and_refute_each_other(self):
        def verdicts(*values):
            answers = [["feasible" if low else "unverified", "", 1.0, 9.0, value] for value, low in values]
            check_solutions.compare(answers)
            return [answer[0] for answer in answers]
        self.assertEqual(verdicts((-2.0, False), (-2.0, False)), ["agreed", "agreed"])
        self.assertEqual(verdicts((-2.0, False)), ["unverified"])
        self.assertEqual(verdicts((-2.0, False), (-3.0, True)), ["wrong", "feasible"])
        self.assertEqual(verdicts((-2.0, False), (-2.5, False)), ["wrong", "unverified"])
        self.assertEqual(verdicts((math.inf, False), (-3.0, True)), ["wrong", "feasible"])
        self.assertEqual(verdicts((-2.0, False), (-2.5, False), (-2.5, False)), ["wrong", "agreed", "agreed"])

    def test_the_archive_is_whole(self):
        out, archive = os.path.join(self.folder, "fast"), os.path.join(self.folder, "packed.tar.gz")
        self.checked("fast", "echo =status= unknown > {sol}")
        done = subprocess.run([os.path.join(SCRIPTS, "archive"), archive, self.library, out], capture_output=True, text=True, check=False,
                              env=os.environ | {"CONELANE": PROGRAM})
        self.assertEqual(done.returncode, 0, done.stderr)
        shutil.unpack_archive(archive, self.folder)
        packed = os.path.join(self.folder, "packed")
        self.assertEqual(subprocess.run(["sha256sum", "--quiet", "-c", "SHA256SUMS"], cwd=packed, check=False).returncode, 0)
        names = set(os.listdir(os.path.join(packed, "certificates")))
        self.assertLessEqual({"default_near_far.certificates.jsonl", "shape_near_far.certificates.jsonl"}, names)
        self.assertEqual(subprocess.run([PROGRAM, "certify", "--verify", os.path.join(packed, "certificates", "default_near_far.certificates.jsonl"),
                                         "--scenes", os.path.join(packed, "library", "conelane.scenes.jsonl")], capture_output=True, check=False).returncode, 0)

    def test_the_fastest_proof_enters_the_index(self):
        library = os.path.join(self.folder, "classes")
        shutil.copytree(self.library, library)
        name = check_solutions.name_of(check_solutions.index_of(library)[0])
        check_solutions.write_classes(library, {"quick": {name: ["proven", "", 1e-9, 1.0, -1.0]}, "liar": {name: ["wrong", "", 1e-10, 1.0, -9.0]}})
        rows = check_solutions.index_of(library)
        self.assertEqual((rows[0]["first_by"], rows[0]["class"]), ("quick", "easy"))
        self.assertNotEqual(rows[1]["first_by"], "quick")

    def test_wrong_answers_are_found_and_only_these(self):
        for name, command, code, said in (
                ("nothing_chosen", "printf '=status= optimal\\n=obj= 0\\n' > {sol}", 1, "outside"),
                ("infeasible", "echo =infeas= > {sol}", 1, "claimed to be infeasible"),
                ("unknown", "printf 'nothing 1\\n=status= optimal\\n' > {sol}", 1, "there is no column nothing"),
                ("fraction", "awk '/INTORG/{i=1} i && / cost /{print $1, 0.5; exit}' {mps} > {sol}", 1, "not a whole number"),
                ("no_point", "echo =status= unknown > {sol}", 0, "easy"),
                ("crash", "kill -SEGV $$", 0, "exit code -11")):
            check = self.checked(name, command, "--formulation", "tight")
            self.assertIn(said, check.stdout)
            self.assertEqual(check.returncode, code, check.stdout)

    def test_a_claim_that_the_library_does_not_know_is_unverified(self):
        program = self.read(mps.read_mps, PROGRAM_TEXT)
        optimum = mps.Solution("optimal", -2.0, None, {"y": 1.0})
        for known, verdict in (({}, "unverified"), ({"=best=": -2.0}, "unverified"), ({"=best=": -1.0}, "unverified"),
                               ({"=best=": -1.0, "=bestdual=": -2.5}, "unverified"), ({"=best=": -2.0, "=bestdual=": -2.0}, "proven"),
                               ({"=opt=": -2.0}, "proven"), ({"=best=": -2.5}, "wrong"), ({"=opt=": -1.0}, "wrong"),
                               ({"=best=": -1.0, "=bestdual=": -1.5}, "wrong"), ({"=inf=": None}, "wrong")):
            with self.subTest(known):
                self.assertEqual(check_solutions.judged(program, optimum, known)[0], verdict)
        self.assertEqual(check_solutions.judged(program, mps.Solution("infeasible"), {})[0], "unverified")
        for claimed in (mps.Solution("optimal", -3.0, None, {"y": 1.0}), mps.Solution("optimal", -2.0, -1.0, {"y": 1.0}),
                        mps.Solution("optimal", -2.0, None, {"y": 3.0}), mps.Solution("optimal", -2.0, None, {"y": 0.6}),
                        mps.Solution("feasible", -1.0, -1.5, {"x": 1.0}), mps.Solution("unknown", None, math.inf)):
            self.assertEqual(check_solutions.judged(program, claimed, {"=opt=": -2.0})[0], "wrong")

    def test_contradictions_in_a_solution_cannot_be_read(self):
        head = "Optimal - objective value -2\n 1 y 1 -2\n"
        for text in (head + " 1 y 1 -2\n", head + "=obj= -3\n", head.replace("Optimal", "Stopped on time") + "=status= optimal\n"):
            with self.assertRaises(ValueError):
                self.read(mps.read_solution, text, ["x", "y"])

    def test_a_program_is_read(self):
        program = self.read(mps.read_mps, PROGRAM_TEXT)
        self.assertEqual((program.cost, program.bounds, program.integer), ({"x": -1.0, "y": -2.0}, {"x": (0.0, 1.0), "y": (0.0, 1.0)}, {"x", "y"}))
        self.assertIsNone(mps.violation(program, {"y": 1.0}))
        self.assertIn("row both", mps.violation(program, {"x": 1.0, "y": 1.0}))
        self.assertIn("not a whole number", mps.violation(program, {"y": 0.5}))
        self.assertIn("outside", mps.violation(program, {"y": 2.0}))
        self.assertEqual(mps.objective_of(program, {"y": 1.0}), -2.0)

    def test_each_format_of_a_solution_is_read(self):
        texts = {
            "cbc": "Optimal - objective value -2.00000000\n      1 y                      1                      -2\n",
            "cbc stopped": "Stopped on time - objective value -2.0\n** 1 y 1 -2\n",
            "cbc within a gap": "Optimal (within gap tolerance) - objective value -2.0\n 1 y 1 -2\n",
            "cbc with rows": "Stopped on time - objective value -2.0\n 0 both 1 0\n 1 y 1 -2\n",
            "glpsol": "c Problem: two\ns mip 2 2 o -2\ni 1 1\nj 1 0\nj 2 1\ne o f\n",
            "highs": "Model status\nOptimal\n\n# Primal solution values\nFeasible\nObjective -2\n# Columns 2\nx 0\ny 1\n# Rows 1\nboth 1\n"
                     "\n# Dual solution values\nNone\n",
            "scip": "solution status: optimal solution found\nobjective value:                 -2\ny    1 \t(obj:-2)\n",
            "gurobi": "# Objective value = -2\nx 0\ny 1\n",
            "miplib": "=obj= -2\ny 1\n",
        }
        for name, text in texts.items():
            with self.subTest(name):
                solution = self.read(mps.read_solution, text, ["x", "y"], {"both", "one"})
                self.assertEqual(solution.objective, -2.0)
                self.assertEqual({column: value for column, value in solution.values.items() if value}, {"y": 1.0})
                self.assertEqual(solution.status, "optimal" if name in ("cbc", "glpsol", "highs", "scip") else "feasible")


if __name__ == "__main__":
    unittest.main()
