"""tutorial_solver_test.py ROOT BUILD CTEST SUITES PROGRAM: the solver that the tutorial adds passes the suites, SUITES, that
the page says run on it; the program with it, PROGRAM, compares it with others; and every pattern that a page gives
to `ctest -R` selects a test of the build or of the suites. Exit code 77 where the build has not all tests."""

import os
import re
import subprocess
import sys
import tempfile
import unittest

from tutorial_pages import documented_test_patterns, tutorial_blocks

ROOT, BUILD, CTEST, SUITES, PROGRAM = sys.argv[1:]


def output_of(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    if done.returncode != 0:
        raise AssertionError(f"exit code {done.returncode} of {' '.join(command)}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}")
    return done.stdout


def suite_tests():
    """The names that CTest would know the tests of the suites by."""
    names, suite = [], ""
    for line in output_of(SUITES, "--gtest_list_tests").splitlines():
        word = line.split("#")[0].strip()
        if word.endswith("."):
            suite = word
        elif line.startswith("  "):
            names.append(suite + word)
    return names


class TutorialSolver(unittest.TestCase):
    def page_pattern(self):
        patterns = {pattern for page, pattern in documented_test_patterns(ROOT) if page == os.path.join("docs", "tutorial-researcher.md")}
        self.assertEqual(len(patterns), 1, "the tutorial chooses its tests in one way")
        return patterns.pop()

    def test_passes_the_suites_that_run_on_it(self):
        chosen = [name for name in suite_tests() if re.search(self.page_pattern(), name)]
        for suite in ("SolverContract", "SolverRobustness"):
            self.assertTrue(any(f"/{suite}." in name for name in chosen), f"{suite} does not run on the tutorial's solver")
        told = output_of(SUITES, "--gtest_filter=" + ":".join(chosen))
        self.assertIn(f"[  PASSED  ] {len(chosen)} tests.", told)

    def test_is_compared_by_the_program(self):
        (study,) = [block for block in tutorial_blocks(ROOT, "bash") if block.startswith("conelane study backends")]
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(PROGRAM, os.path.join(folder, "conelane"))
            environment = os.environ | {"PATH": folder + os.pathsep + os.environ["PATH"]}
            scenes = tutorial_blocks(ROOT, "sh")[0]
            table = output_of("bash", "-euo", "pipefail", "-c", scenes + study, cwd=folder, env=environment)
        self.assertRegex(table, r"(?m)^.*edge-branching.*\d")


class TestPatterns(unittest.TestCase):
    def test_each_selects_a_test(self):
        built = re.findall(r"^ *Test +#\d+: (.*)$", output_of(CTEST, "--test-dir", BUILD, "-N"), flags=re.M)
        names = built + suite_tests()
        patterns = list(documented_test_patterns(ROOT))
        self.assertGreaterEqual(len(patterns), 2)
        lost = [f"{page}: -R {pattern}" for page, pattern in patterns if not any(re.search(pattern, name) for name in names)]
        if lost and any(name.endswith("_NOT_BUILT") for name in built):
            self.skipTest("not all tests are built, and these select none: " + ", ".join(lost))
        self.assertEqual(lost, [])


if __name__ == "__main__":
    result = unittest.main(argv=sys.argv[:1], exit=False).result
    sys.exit(77 if result.wasSuccessful() and result.skipped else not result.wasSuccessful())
