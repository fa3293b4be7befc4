"""stubs.py MODULE OUT: the type stubs of a compiled module of the package, from its docstrings: the signature that the docstring of a function
or class begins with, the types of its sections Parameters and Returns, and the type that the docstring of an attribute begins with."""
import importlib.util
import inspect
import re
import sys

HEAD = """from os import PathLike
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from matplotlib.axes import Axes
from numpy import float32, float64, int64, uint8
from numpy.typing import ArrayLike, NDArray

version: str
"""
OPTIONS = ("nearest", "parameters", "pairing", "weights")  # of a detector
TYPES = {"str or os.PathLike": 'Union[str, "PathLike[str]"]', "str, os.PathLike or bytes": 'Union[str, "PathLike[str]", bytes]',
         "str or dict": "Union[str, Mapping[str, Any]]", "dict of str to float, str or bool": "Dict[str, Any]", "matplotlib.axes.Axes": "Axes"}


def type_of(text):
    """The annotation for a type as docstrings have it."""
    text = text.strip()
    if text in TYPES:
        return TYPES[text]
    for mark in (" or None", ", optional"):
        if text.endswith(mark):
            return f"Optional[{type_of(text[:-len(mark)])}]"
    for pattern, annotation in ((r"dict of (\w+) to (\w+)", "Dict[{}, {}]"), (r"sequence of (\w+)", "Sequence[{}]"),
                                (r"list of (\w+)", "List[{}]"), (r"\([^)]*\) ndarray of (\w+)", "NDArray[{}]")):
        if match := re.fullmatch(pattern, text):
            return annotation.format(*match.groups())
    if match := re.fullmatch(r"list of \((.*)\)", text):
        return f"List[Tuple[{match[1]}]]"
    if match := re.fullmatch(r"tuple of two (.*)", text):
        return "Tuple[{0}, {0}]".format(type_of(match[1]))
    if "array_like" in text:
        return "ArrayLike"
    if re.fullmatch(r"\w+", text):
        return text
    raise SystemExit(f"stubs.py: there is no annotation for '{text}'")


def section(doc, title):
    """The lines of a section that are not indented."""
    found = re.search(rf"^{title}\n-+\n((?:.+\n)*)", doc, flags=re.M)
    return re.findall(r"^\S.*", found[1], flags=re.M) if found else []


def parameter_types(doc, known):
    """By name. Parameters without a type are as those of the same names elsewhere."""
    for line in section(doc, "Parameters"):
        names, _, kind = line.partition(" : ")
        for name in names.split(", "):
            if kind and kind != "optional":
                known[name] = type_of(kind)
    return known


def function(doc, known, indent="", name=None):
    own_name, _, given = doc.strip().splitlines()[0][:-1].partition("(")
    types = parameter_types(doc, dict(known))
    arguments = ["self"] if indent else []
    options = ("" if "*, " in given else "*, ") + ", ".join(f"{option}=None" for option in OPTIONS)
    for argument in given.replace("**options", options).split(", "):
        key, equals, default = argument.partition("=")
        arguments += [key] if key == "*" else [f"{key}: {types[key]}" + (f" = {default}" if equals else "")] if key else []
    returned = section(doc, "Returns")
    result = "None" if name or not returned else type_of(returned[0])
    return f"{indent}def {name or own_name}({', '.join(arguments)}) -> {result}: ...\n"


def of_class(name, of, known):
    body = function(of.__doc__, known, "    ", "__init__") if of.__doc__.startswith(f"{name}(") else ""
    for key, member in vars(of).items():
        if isinstance(member, property):
            body += f"    @property\n    def {key}(self) -> {type_of(member.__doc__.partition(':')[0])}: ...\n"
        elif not key.startswith("_"):
            body += function(member.__doc__, known, "    ")
    return f"\nclass {name}:\n{body}"


def main(module_file, out):
    spec = importlib.util.spec_from_file_location("_core", module_file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    known, classes, functions = {}, {}, {}
    for name, member in vars(module).items():
        if not name.startswith("_") and name != "version":
            (classes if inspect.isclass(member) else functions)[name] = member
    for of in [*classes.values(), *functions.values(), *(member for of in classes.values() for member in vars(of).values())]:
        parameter_types(getattr(of, "__doc__", None) or "", known)
    text = HEAD + "".join(of_class(name, of, known) for name, of in classes.items()) + "\n"
    text += "".join(function(of.__doc__, known) for of in functions.values())
    with open(out, "w", encoding="utf-8") as stream:
        stream.write(text)


if __name__ == "__main__":
    main(*sys.argv[1:])
