"""Every example of the docstrings and of the pages about Python runs; the stubs say what the module has.

python3 docs_test.py SOURCES
"""
import ast
import doctest
import functools
import inspect
import os
import re
import sys
import tempfile
import unittest
from pathlib import Path

import conelane
import conelane._core
import conelane.bags
import conelane.frames
import conelane.ft_fsd
import conelane.messages
import conelane.replay

SOURCES = Path(sys.argv.pop(1)) if len(sys.argv) > 1 else Path(__file__).parents[2]

for of, method in ((conelane.Detector, "detect"), (conelane.Detector, "detect_scene"), (conelane.Planner, "update")):
    call = getattr(of, method)  # without a limit: a pause of the machine breaks no example
    setattr(of, method, functools.wraps(call)(lambda *given, call=call, **more: call(*given, **{**more, "time_limit_ms": None})))


def documented(thing, name):
    """A class or function and its members, each with its name and docstring."""
    yield name, thing.__doc__
    if inspect.isclass(thing):
        for key, member in vars(thing).items():
            if not key.startswith("_") and getattr(member, "__doc__", None):
                yield f"{name}.{key}", member.__doc__


def all_docstrings():
    for module in (conelane, conelane.bags, conelane.frames, conelane.ft_fsd, conelane.messages, conelane.replay):
        yield module.__name__, module.__doc__, vars(module)
        for name in module.__all__:
            for member, text in documented(getattr(module, name), f"{module.__name__}.{name}"):
                yield member, text, vars(module)


class Docstrings(unittest.TestCase):
    def test_every_example_runs(self):
        parser, runner = doctest.DocTestParser(), doctest.DocTestRunner()
        for name, text, names in all_docstrings():
            runner.run(parser.get_doctest(text or "", dict(names), name, name, 0))
        self.assertEqual(runner.failures, 0)
        self.assertGreater(runner.tries, 60)

    def test_everything_public_has_a_docstring(self):
        missing = [name for name, text, _ in all_docstrings() if not (text or "").strip()]
        self.assertEqual(missing, [])


class Stubs(unittest.TestCase):
    """_core.pyi, which is made of the docstrings, has every name, and what an attribute holds is of the type that it names."""

    TYPES = {"float": float, "int": int, "bool": bool, "str": str, "List": list, "Dict": dict, "Tuple": tuple}

    def test_attributes_are_of_their_types(self):
        stubs = ast.parse(Path(conelane._core.__file__).with_name("_core.pyi").read_text(encoding="utf-8"))
        named = {node.name: node for node in stubs.body if hasattr(node, "name")}
        self.assertEqual(set(named), {name for name in vars(conelane._core) if not name.startswith("_")} - {"version"})
        track, = conelane.load_tracks("generated:circle")
        scene = conelane.generate_scenes(track, every_m=20.0)[0]
        detector, planner = conelane.Detector("front"), conelane.Planner()
        lane, plan = detector.detect_scene(scene, time_limit_ms=None), planner.update(scene.cones, scene.pose, 0.0, time_limit_ms=None)
        for one in (track, track.boundaries, scene, detector, lane, lane.drivable(), conelane.score(scene, lane, track.boundaries), planner, plan,
                    plan.answer, conelane.solve_rld(scene.cones, scene.pose)):
            members = {node.name: node for node in named[type(one).__name__].body}
            self.assertEqual(set(members) - {"__init__"}, {name for name in vars(type(one)) if not name.startswith("_")})
            for name, node in members.items():
                if node.decorator_list:
                    text, value = ast.unparse(node.returns), getattr(one, name)
                    self.assertTrue(value is not None or text.startswith("Optional["), f"{type(one).__name__}.{name}: {text}")
                    kind = re.match(r"(?:Optional\[)?(?:NDArray\[(\w+)|(\w+))", text)
                    if value is not None and kind[1]:
                        self.assertEqual(str(value.dtype), kind[1], name)
                    elif value is not None:
                        self.assertIsInstance(value, self.TYPES.get(kind[2]) or getattr(conelane, kind[2]), name)


class Pages(unittest.TestCase):
    """The ```python blocks of a page run one after the other, in a folder of their own, as a reader would run them."""

    def run_page(self, page):
        text = (SOURCES / page).read_text(encoding="utf-8")
        blocks = [(match.start(), match.group(1)) for match in re.finditer(r"^```python\n(.*?)^```", text, re.M | re.S)]
        names = {"__name__": page}
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                for start, code in blocks:
                    line = text[:start].count("\n") + 1
                    exec(compile("\n" * line + code, page, "exec"), names)
            finally:
                os.chdir(before)
        return names, len(blocks)

    def test_python_page(self):
        import matplotlib

        matplotlib.use("Agg")
        names, blocks = self.run_page("docs/python.md")
        self.assertGreater(blocks, 5)
        # What the tutorial promises of its own numbers.
        self.assertTrue(all(len(line) for line in names["lines"]))
        self.assertGreater(names["usable_share"], 0.9)

    def test_readme(self):
        names, blocks = self.run_page("README.md")
        self.assertEqual(blocks, 1)
        self.assertEqual((names["plan"].state, names["plan"].stop), ("following", False))
        self.assertEqual(names["plan"].answer.status, "found")

    def test_messages_page(self):
        _, blocks = self.run_page("docs/messages.md")
        self.assertGreater(blocks, 0)


if __name__ == "__main__":
    unittest.main()
