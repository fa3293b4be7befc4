"""What the tests of the pages read of them."""

import glob
import os
import re


def text_of(path):
    with open(path, encoding="utf-8") as stream:
        return stream.read()


def tutorial_blocks(root, language):
    """The blocks of the tutorial in a language, in their order."""
    page = text_of(os.path.join(root, "docs", "tutorial-researcher.md"))
    return re.findall(rf"^```{language}\n(.*?)^```$", page, flags=re.M | re.S)


def documented_test_patterns(root):
    """(page, pattern) of every `ctest ... -R PATTERN` and `tests/run -R PATTERN`; words in capitals stand for many."""
    pages = sorted(glob.glob(os.path.join(root, "docs", "**", "*.md"), recursive=True)) + [os.path.join(root, name) for name in ("README.md", "CONTRIBUTING.md")]
    for page in pages:
        for quoted, bare in re.findall(r"\b(?:ctest|tests/run)\b[^`\n#|;&]*? -R (?:'([^'\n]*)'|([^\s`'\"]+))", text_of(page)):
            if not re.fullmatch(r"[A-Z]+", bare or "-"):
                yield os.path.relpath(page, root), quoted or bare
