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

# (pattern in lower case, what to write). Case is ignored; a space stands for any white space.
PHRASES = [
    (r"\b(\w+) that (?:is|are) no \1", "invalid ..."),
    (r"that (?:is|are) none\b", "that does not exist, invalid"),
    (r"no proof is claimed", "every claimed optimum is an optimum"),
    (r"and of a start with error", "also the warm start, if status is error"),
    (r"takes? the time and the memory that", "no time or memory limit"),
    (r"the limit that its making ran into", "why construction stopped"),
    (r"once (?:it|the clock) has struck", "once the time has ended; expiry is sticky"),
    (r"(?:limit|deadline)(?: was| had| has| is)? (?:struck|strikes)", "the limit ended it"),
    (r"what of an? \w+ (?:lies|is|are|they)", "the ... restricted to"),
    (r"(?:right )?all but surely", "with calibrated probability; nearly always"),
    (r"(?:hangs?|hung) by a thread", "the least certain cone"),
    (r"(?:hangs?|hung) on rounding", "depends on rounding"),
    (r"no failure leaves", "failures count in every mean"),
    (r"(?:found|drawn|driven|told|learned|measured) anew", "... again, retrained"),
    (r"\bmend(?:s|ed|ing)?\b", "fix"),
    (r"such ones", "name the thing again"),
    (r"the (?:longer|larger|shorter|smaller|nearer|farther) of both", "name the two things"),
    (r"probability that the lane is right", "probability that the lane is usable"),
    (r"nobody'?s fit", "not fitted"),
    (r"goes on where it was(?: stopped)?", "resumes"),
    (r"little sure", "uncertain"),
    (r"is its business", "..."),
    (r"on an? (?:loaded|busy|slower) (?:machine|day)", "docs/benchmarks/ and the machine"),
    (r"(?:with|while) other (?:programs|work) (?:ran|runs?|running|shared)", "docs/benchmarks/ and the machine"),
    (r"beside other work", "docs/benchmarks/ and the machine"),
    (r"the other core was at work|both cores at work", "docs/benchmarks/ and the machine"),
    (r"last week|this week|last session|this session|yesterday", "CHANGELOG.md"),
    (r"the program before it|the code of today|today's (?:code|arithmetic|program)", "CHANGELOG.md"),
    (r"\b(?:built|builds?|written|placed|solved|fitted|linked|stored?|start(?:s|ed)?|search(?:es|ed)?|draw) (?:\w+ ){0,2}anew\b", "... again"),
    (r"\bheld against\b|\bholds? (?:\w+ ){1,5}against\b", "compared with"),
    (r"\bbe it (?:a|an|by|that|under|with|through)\b", "also if, or"),
    (r"looks? at (?:the|its) (?:clock|deadline)", "checks of the clock"),
    (r"\bclock (?:strikes|struck)\b", "the time ends"),
    (r"\bto be asked before\b", "call it before"),
    (r"\b(?:one|two|three|four) at least\b", "at least two"),
    (r"\bwhat (?:became|becomes) of\b", "the outcome of"),
    (r"\bthe very (?:cones|lane|same|scene)\b", "exactly the same"),
    (r"\bwhat is no\b", "an invalid ...; name the thing"),
    (r"\bcut short\b", "interrupted, truncated"),
    (r"\bhardly ever\b", "rarely"),
    (r"\ba lane to drive by\b", "a usable lane"),
    (r"\bwent wrong, or nothing\b", "the failure in words, or nothing"),
]
# In documents only, but not in the change log.
DIARY = [
    (r"\(\d[^()]{0,40} before\)", "CHANGELOG.md"),
    (r"\bbefore (?:and|/) after\b", "docs/benchmarks/ or CHANGELOG.md"),
    (r"since (?:yesterday|today)|until (?:yesterday|today)|as of today|of today\b", "the version"),
]
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
