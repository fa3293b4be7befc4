"""stubs.py MODULE OUT: the type stubs of a compiled module of the package, from its docstrings: that of a function or class begins with the
signature, that of an attribute with the type."""
import importlib.util
import inspect
import sys

HEAD = """from os import PathLike
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from matplotlib.axes import Axes
from numpy import float32, float64, int64, uint8
from numpy.typing import ArrayLike, NDArray

version: str
"""
OPTIONS = ("*, nearest: Optional[int] = None, parameters: Optional[Union[str, Mapping[str, Any]]] = None, "
           'pairing: Optional[str] = None, weights: Optional[Union[str, "PathLike[str]", bytes]] = None')  # of a detector


def function(doc, indent="", name=None):
    own_name, _, rest = " ".join(doc.split("\n\n")[0].split()).partition("(")
    rest = rest.replace("**options", OPTIONS[3:] if "*, " in rest else OPTIONS)
    first = "self" + (", " if rest[0] != ")" else "") if indent else ""
    return f"{indent}def {name or own_name}({first}{rest}{' -> None' if name else ''}: ...\n"


def of_class(name, of):
    text = f"\nclass {name}:\n"
    if of.__doc__.startswith(f"{name}("):
        text += function(of.__doc__, "    ", "__init__")
    for key, member in vars(of).items():
        if isinstance(member, property):
            text += f"    @property\n    def {key}(self) -> {member.__doc__.partition(':')[0]}: ...\n"
        elif not key.startswith("_"):
            text += function(member.__doc__, "    ")
    return text if "def" in text else text + "    ...\n"


def main(module_file, out):
    spec = importlib.util.spec_from_file_location("_core", module_file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    members = {name: member for name, member in vars(module).items() if not name.startswith("_") and name != "version"}
    text = HEAD + "".join(of_class(name, of) for name, of in members.items() if inspect.isclass(of)) + "\n"
    text += "".join(function(of.__doc__) for of in members.values() if not inspect.isclass(of))
    with open(out, "w", encoding="utf-8") as stream:
        stream.write(text)


if __name__ == "__main__":
    main(*sys.argv[1:])
