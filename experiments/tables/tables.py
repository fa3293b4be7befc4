"""The tables of README.md and docs/ that are made by one command of one version.

    tables.py collect KIND DIR    the figures of the runs in DIR, as DIR/KIND.json
    tables.py write FILE...       the tables between their markers, and a copy of each file in docs/benchmarks/
    tables.py check               whether the pages say what the files in docs/benchmarks/ say; exit code 1 if not

KIND is held_out or solvers; experiments/tables/KIND makes the runs. A table stands between `<!-- table NAME -->` and
`<!-- end of table -->`.
"""

import json
import os
import re
import sys

import held_out
import parameter_sets
import solvers
from cells import table

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
STORED = os.path.join(ROOT, "docs", "benchmarks")
PAGES = ["README.md", "docs/results.md", "docs/race.md", "docs/path-pair.md", "docs/faq.md", "docs/benchmarks/0.5.md"]
KINDS = {"held_out": held_out, "solvers": solvers}

BLOCK = re.compile(r"(<!-- table (?P<name>[^>]*?) -->\n).*?(<!-- end of table -->)", flags=re.S)


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
    return table(["run", "commit", "compiler", "machine"],
                 [[f"`{name}`", run["commit"], run["compiler"], run["machine"]] for name, run in runs.items()])


def all_tables():
    """The text of each table by its name, from the stored files."""
    texts, runs = {}, {}
    for kind, module in KINDS.items():
        stored = json.loads(read(stored_file(kind)))
        texts |= module.tables(stored)
        runs |= stored["runs"]
    return texts | parameter_sets.tables(ROOT) | {"runs": runs_table(runs)}


def filled(text, tables, page):
    def block(match):
        if match["name"] not in tables:
            raise SystemExit(f"{page}: no table is called '{match['name']}'; there are {', '.join(tables)}")
        return f"{match[1]}{tables[match['name']]}\n{match[3]}"
    return BLOCK.sub(block, text)


def text_of(stored):
    """JSON with a row on each line, so that a change shows."""
    def lines(rows):
        return "[\n" + ",\n".join("    " + json.dumps(row) for row in rows) + "\n  ]"
    return ("{\n" + ",\n".join(f'  "{key}": ' + (lines(value) if isinstance(value, list) else json.dumps(value))
                               for key, value in stored.items()) + "\n}\n")


def write_pages():
    tables = all_tables()
    for page in PAGES:
        path = os.path.join(ROOT, page)
        write(path, filled(read(path), tables, page))


def check():
    tables = all_tables()
    pages = {page: read(os.path.join(ROOT, page)) for page in PAGES}
    named = {match["name"] for text in pages.values() for match in BLOCK.finditer(text)}
    wrong = [f"{page}: a table is not what docs/benchmarks/ says; `experiments/tables/tables.py write` makes it again"
             for page, text in pages.items() if filled(text, tables, page) != text]
    wrong += [f"no page has the table '{name}'" for name in tables if name not in named]
    print("\n".join(wrong) or f"{len(named)} tables are what docs/benchmarks/ says")
    return 1 if wrong else 0


def main(arguments):
    match arguments:
        case ["collect", kind, folder] if kind in KINDS:
            write(os.path.join(folder, f"{kind}.json"), text_of(KINDS[kind].collect(folder)))
        case ["write", *files]:
            for file in files:
                kind = os.path.basename(file).removesuffix(".json")
                if kind not in KINDS:
                    raise SystemExit(f"tables.py: {file}: its name has to be one of {', '.join(f'{kind}.json' for kind in KINDS)}")
                write(stored_file(kind), read(file))
            write_pages()
        case ["check"]:
            return check()
        case _:
            print(__doc__, file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
