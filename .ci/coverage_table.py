"""coverage_table.py SUMMARY.json: what `llvm-cov export --summary-only` counted, by folder and of the files that fall
short. Exit code 1 where a library's folder has less than these shares."""

import json
import sys
from collections import defaultdict
from pathlib import Path

LEAST_PERCENT = {"lines": 95.0, "branches": 85.0}
LIBRARY = ("model", "solvers", "graph_search", "detectors")


def percent(covered, count):
    return 100.0 * covered / count if count else 100.0


def share(counts):
    return f"{counts[0]:6d} of {counts[1]:6d} {percent(*counts):6.2f} %"


def falls_short(figures):
    return any(percent(*figures[measure]) < least for measure, least in LEAST_PERCENT.items())


def main():
    root = Path(__file__).resolve().parent.parent
    files = {}
    folders = defaultdict(lambda: {measure: [0, 0] for measure in LEAST_PERCENT})
    for entry in json.loads(Path(sys.argv[1]).read_text())["data"][0]["files"]:
        path = Path(entry["filename"]).relative_to(root)
        figures = {m: (entry["summary"][m]["covered"], entry["summary"][m]["count"]) for m in LEAST_PERCENT}
        files[path] = figures
        for measure, (covered, count) in figures.items():
            total = folders[path.parts[0]][measure]
            total[0] += covered
            total[1] += count

    print(f"{'folder':<14} {'lines run':>26} {'branches taken':>28}")
    for folder, figures in sorted(folders.items()):
        print(f"{folder:<14} {share(figures['lines']):>26} {share(figures['branches']):>28}")
    low = {path: f for path, f in files.items() if path.parts[0] in LIBRARY and falls_short(f)}
    if low:
        print("\nfiles of the library below " + " or ".join(f"{v:g} % of {k}" for k, v in LEAST_PERCENT.items()))
        for path, figures in sorted(low.items()):
            print(f"{str(path):<52} {share(figures['lines'])} {share(figures['branches'])}")
    missing = [folder for folder in LIBRARY if folder not in folders]
    short = [folder for folder in LIBRARY if folder in folders and falls_short(folders[folder])]
    if missing or short:
        sys.exit("coverage: too little of " + ", ".join(short + missing))


main()
