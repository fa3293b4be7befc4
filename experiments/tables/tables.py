"""The tables of README.md and docs/ that are made by one command of one version.

    tables.py collect KIND DIR    the figures of the runs in DIR, as DIR/KIND.json
    tables.py write FILE...       the tables between their markers, and a copy of each file in docs/benchmarks/
    tables.py check               whether the pages say what the files in docs/benchmarks/ say; exit code 1 if not

KIND is held_out, shipped, solvers or engines; experiments/tables/KIND makes the runs. The KIND reproduce is about the whole run of experiments/reproduce.
A table stands between `<!-- table NAME -->` and `<!-- end of table -->`. A number in a sentence names its cell, `92.4<!--usable:front:8-->`: table,
beginning of the row, number of the column (or the `min` or `max` of the row), and with `:2` the second number of the cell. It keeps its decimals. All
figures are to be of one commit, that of the whole run.
"""

import glob
import json
import os
import re
import sys

import engines
import held_out
import reproduce
import shipped
import solvers
from cells import InputError, read_json, table

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
STORED = os.path.join(ROOT, "docs", "benchmarks")
PAGES = ["README.md", *sorted(os.path.relpath(page, ROOT) for page in glob.glob(os.path.join(ROOT, "docs", "**", "*.md"), recursive=True))]
JUDGE = os.path.join(STORED, "course_judge.json")  # the record of a judge that is not in the project any more
KINDS = {"held_out": held_out, "shipped": shipped, "solvers": solvers, "engines": engines, "reproduce": reproduce}

BLOCK = re.compile(r"(<!-- table (?P<name>[^>]*?) -->\n).*?(<!-- end of table -->)", flags=re.S)
FIGURE = re.compile(r"\d+(?P<decimals>\.\d+)?(?P<cell><!--(?P<table>[^:>]+):(?P<row>[^:>]+):(?P<column>min|max|\d+)(?::(?P<place>\d+))?-->)")


def read(path):
    with open(path, encoding="utf-8") as stream:
        return stream.read()


def write(path, text):
    with open(path + ".part", "w", encoding="utf-8") as stream:
        stream.write(text)
    os.replace(path + ".part", path)


def stored_file(kind):
    return os.path.join(STORED, f"{kind}.json")


def runs_table(runs):
    """The runs of each commit, compiler and machine."""
    machines = {(run["commit"], run["compiler"]): run["machine"] for run in reversed(runs.values()) if run["machine"]}
    by_origin = {}
    for name, run in sorted(runs.items(), key=lambda item: item[1]["machine"] == ""):
        build = (run["commit"], run["compiler"])
        # Where there is no record of it, the machine is that of another run of the program.
        by_origin.setdefault((*build, run["machine"] or machines.get(build, "")), []).append(f"`{name}`")
    return table(["commit", "compiler", "machine", "runs"], [[*origin, ", ".join(names)] for origin, names in by_origin.items()])


def stored_figures():
    """By kind; nothing for a file that is missing, as there may be figures without a whole run."""
    return {kind: read_json(stored_file(kind)) if os.path.exists(stored_file(kind)) else {} for kind in KINDS}


def all_tables(stored):
    """The text of each table by its name, from the stored files."""
    texts, runs = {}, {}
    for kind, module in KINDS.items():
        texts |= module.tables(stored[kind])
        runs |= stored[kind].get("runs", {})
    judge = read_json(JUDGE)
    return texts | {"judge of twelve cones": held_out.judge_table(judge), "runs": runs_table(runs | judge["runs"])}


def strangers(stored):
    """The runs that are not of the commit of the whole run, where there was a whole run. Engines may be measured again by themselves, as more of
    them come; their table says of which commit they are."""
    commit = stored["reproduce"].get("commit")
    return [f"docs/benchmarks/{kind}.json: the run '{name}' is of commit {run['commit']}, the whole run of {commit}: experiments/reproduce makes all again"
            for kind in KINDS if kind != "engines" for name, run in stored[kind].get("runs", {}).items() if commit is not None and run["commit"] != commit]


def filled(text, tables, page):
    def block(match):
        if match["name"] not in tables:
            raise SystemExit(f"{page}: no table is called '{match['name']}'; there are {', '.join(tables)}")
        return f"{match[1]}{tables[match['name']]}\n{match[3]}"

    def figure(match):
        rows = [line.replace("`", "").strip("| ").split(" | ") for line in tables.get(match["table"], "").splitlines()]
        cells = min((cells for cells in rows if cells[0].startswith(match["row"])), key=lambda cells: len(cells[0]), default=[])
        numbers = [re.findall(r"\d+(?:\.\d+)?", cell)[int(match["place"] or 1) - 1:] for cell in cells[1:]]
        values = [float(number[0]) for number in numbers if number]
        pick = {"min": min, "max": max}.get(match["column"], lambda values: values[int(match["column"]) - 1])
        if not values or match["column"].isdigit() and int(match["column"]) > len(values):
            raise SystemExit(f"{page}: no table has the cell of {match['cell']}")
        return f"{pick(values):.{max(0, len(match['decimals'] or '') - 1)}f}{match['cell']}"
    return FIGURE.sub(figure, BLOCK.sub(block, text))


def text_of(stored):
    """JSON with a row on each line, so that a change shows."""
    def lines(rows):
        return "[\n" + ",\n".join("    " + json.dumps(row) for row in rows) + "\n  ]"
    return ("{\n" + ",\n".join(f'  "{key}": ' + (lines(value) if isinstance(value, list) else json.dumps(value))
                               for key, value in stored.items()) + "\n}\n")


def write_pages(files):
    """The figures of the files by their kind, then the pages; nothing is written if they do not make all tables."""
    stored = stored_figures() | {kind: json.loads(text) for kind, text in files.items()}
    tables = all_tables(stored)
    pages = {os.path.join(ROOT, page): filled(read(os.path.join(ROOT, page)), tables, page) for page in PAGES}
    for path, text in [(stored_file(kind), text) for kind, text in files.items()] + list(pages.items()):
        write(path, text)


def check():
    stored = stored_figures()
    tables = all_tables(stored)
    pages = {page: read(os.path.join(ROOT, page)) for page in PAGES}
    named = {match["name"] for text in pages.values() for match in BLOCK.finditer(text)}
    wrong = [f"{page}: a table is not what docs/benchmarks/ says; `experiments/tables/tables.py write` makes it again"
             for page, text in pages.items() if filled(text, tables, page) != text]
    wrong += [f"no page has the table '{name}'" for name in tables if name not in named]
    wrong += strangers(stored)
    print("\n".join(wrong) or f"{len(named)} tables are what docs/benchmarks/ says")
    return 1 if wrong else 0


def main(arguments):
    match arguments:
        case ["collect", kind, folder] if kind in KINDS:
            write(os.path.join(folder, f"{kind}.json"), text_of(KINDS[kind].collect(folder)))
        case ["write", *files]:
            named = {os.path.basename(file).removesuffix(".json"): file for file in files}
            for kind, file in named.items():
                if kind not in KINDS:
                    raise SystemExit(f"tables.py: {file}: its name has to be one of {', '.join(f'{kind}.json' for kind in KINDS)}")
            write_pages({kind: read(file) for kind, file in named.items()})
        case ["check"]:
            return check()
        case _:
            print(__doc__, file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except InputError as error:
        raise SystemExit(f"tables.py: {error}") from None
