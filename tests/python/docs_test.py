"""Every example of the docstrings and of the pages about Python runs; the stubs say what the module has.

python3 docs_test.py SOURCES
"""
import ast
import doctest
import inspect
import os
import re
import sys
import tempfile
import unittest
from pathlib import Path

import conelane
import conelane._core
import conelane.ft_fsd
import conelane.messages

SOURCES = Path(sys.argv.pop(1)) if len(sys.argv) > 1 else Path(__file__).parents[2]


def documented(thing, name):
    """A class or function and its members, each with its name and docstring."""
    yield name, thing.__doc__
    if inspect.isclass(thing):
        for key, member in vars(thing).items():
            if not key.startswith("_") and getattr(member, "__doc__", None):
                yield f"{name}.{key}", member.__doc__


def all_docstrings():
    for module in (conelane, conelane.ft_fsd, conelane.messages):
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
    """_core.pyi lists what the module has, with the arguments that docstrings begin with."""

    def setUp(self):
        tree = ast.parse((SOURCES / "python/conelane/_core.pyi").read_text(encoding="utf-8"))
        self.functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
        self.classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}

    def test_names(self):
        self.assertEqual({name for name in vars(conelane._core) if not name.startswith("_")} - {"version"},
                         set(self.functions) | set(self.classes))
        for name, node in self.classes.items():
            members = {member.name for member in node.body if isinstance(member, ast.FunctionDef)}
            real = {key for key in vars(getattr(conelane._core, name)) if not key.startswith("_")}
            self.assertEqual(members - {"__init__"}, real, name)

    def test_arguments(self):
        def check(name, node, text):
            said = ast.parse(f"def {text.strip().splitlines()[0]}: pass").body[0].args
            stub = node.args
            names = [[arg.arg for arg in args] for args in (stub.args, stub.kwonlyargs)]
            if names[0][:1] == ["self"]:
                names[0].pop(0)
            if said.kwarg is None:  # **options are spelled out in the stub
                self.assertEqual(names, [[arg.arg for arg in args] for args in (said.args, said.kwonlyargs)], name)
                self.assertEqual([ast.dump(value) for value in stub.defaults + stub.kw_defaults if value],
                                 [ast.dump(value) for value in said.defaults + said.kw_defaults if value], name)

        for name, node in self.functions.items():
            check(name, node, getattr(conelane._core, name).__doc__)
        for name, node in self.classes.items():
            for member in node.body:
                if not isinstance(member, ast.FunctionDef) or member.decorator_list:
                    continue
                owner = getattr(conelane._core, name)
                check(name, member, owner.__doc__ if member.name == "__init__" else getattr(owner, member.name).__doc__)


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
