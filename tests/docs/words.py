"""words.py [ROOT]: the phrases that docs/style.md keeps out of the project. Prints FILE:LINE for each one found in a document, comment
or message, and for each commit hash outside docs/benchmarks/ and CHANGELOG.md; exit code 1 if there are any.

Lines are joined before the search, so a phrase is found across a line break of a document, a comment or a string."""

import bisect
import fnmatch
import os
import re
import subprocess
import sys

COVERED = ("*.md", "*.hpp", "*.cpp", "*.py", "*.mjs", "*.d.ts", "*.cmake", "CMakeLists.txt", "*.in")
# These two list the phrases. docs/style.md may quote them, this file has to.
LISTS = ("docs/style.md", "tests/docs/words.py", "tests/docs/words_test.py")
HASHES_ALLOWED = ("docs/benchmarks/", "CHANGELOG.md")


def read_phrases():
    """(pattern, what to write) of words.txt: those for all files, and those for documents alone."""
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "words.txt"), encoding="utf-8") as stream:
        parts = stream.read().split("[documents]")
    return [[tuple(line.split("\t")) for line in part.splitlines() if line and not line.startswith("#")] for part in parts]


PHRASES, DIARY = read_phrases()
# At least seven hexadecimal digits with a letter and a digit among them; not 0x..., not part of a word, a path or a longer number.
HASH = re.compile(r"(?<![\w./#%-])(?=[0-9a-f]*[0-9])(?=[0-9a-f]*[a-f])(?:[0-9a-f]{7,12}|[0-9a-f]{40})(?![\w./-]*\w)")
NUMBER_WITH_EXPONENT = re.compile(r"\d+e\d+")

MARK = r"(?:///<|///|//!|//|#+(?= )|\*(?!\*)|>)?"
BREAK = re.compile(r'"?[ \t]*\n[ \t]*' + MARK + r'[ \t]*"?')


def joined(text):
    """The text with each line break, and the marks of comments and strings around it, as one space; and where its lines begin."""
    parts, starts, lines, at, length = [], [0], [1], 0, 0
    line = 1
    for found in BREAK.finditer(text):
        piece = text[at:found.start()]
        blank = piece.strip() == ""
        parts.append(piece)
        length += len(piece)
        # A blank line ends a paragraph: no phrase crosses it.
        separator = "\n" if blank else " "
        parts.append(separator)
        length += 1
        line += 1
        starts.append(length)
        lines.append(line)
        at = found.end()
    parts.append(text[at:])
    return re.sub(r'[ \t]', " ", "".join(parts)), starts, lines


def problems_of(name, text):
    """(line, what was found, what to write) of each phrase and commit hash in a file's text."""
    flat, starts, lines = joined(text)

    def line_of(offset):
        return lines[bisect.bisect_right(starts, offset) - 1]

    if name not in LISTS:
        lower = flat.lower()
        diary = DIARY if name.endswith(".md") and name not in HASHES_ALLOWED else []
        for pattern, instead in PHRASES + diary:
            if instead.startswith(HASHES_ALLOWED[0]) and name.startswith(HASHES_ALLOWED[0]):
                continue  # there it is allowed to name the load of the machine
            for found in re.finditer(pattern.replace(" ", " +"), lower):
                yield line_of(found.start()), f'"{" ".join(found.group().split())}"', instead
    if not name.startswith(HASHES_ALLOWED[0]) and name not in HASHES_ALLOWED and name not in LISTS:
        for found in HASH.finditer(flat):
            if not NUMBER_WITH_EXPONENT.fullmatch(found.group()):
                yield line_of(found.start()), f"commit hash {found.group()}", "docs/benchmarks/VERSION.md or CHANGELOG.md"


def files_of(root):
    """What git tracks or would track; without git, all files but those of builds."""
    listed = subprocess.run(["git", "-c", f"safe.directory={root}", "ls-files", "-co", "--exclude-standard"], cwd=root, capture_output=True,
                            text=True, check=False)
    if listed.returncode == 0:
        names = listed.stdout.splitlines()
    else:
        names = []
        for folder, below, found in os.walk(root):
            below[:] = [name for name in below if name not in ("build", "results", "node_modules", ".git")]
            names += [os.path.relpath(os.path.join(folder, name), root) for name in found]
    return sorted(name for name in set(names) if any(fnmatch.fnmatch(os.path.basename(name), pattern) for pattern in COVERED)
                  and os.path.isfile(os.path.join(root, name)))


def main():
    root = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else ".")
    names, count = files_of(root), 0
    for name in names:
        with open(os.path.join(root, name), encoding="utf-8") as stream:
            for line, what, instead in problems_of(name, stream.read()):
                print(f"{name}:{line}: {what}; write: {instead}")
                count += 1
    print(f"{len(names)} files, {count} to rewrite (docs/style.md)")
    return 1 if count or not names else 0


if __name__ == "__main__":
    sys.exit(main())
