"""reference_pages.py ROOT PROGRAM FIELDS [--write]: docs/commands.md from the --help of the program, docs/parameters.md from the parameter
fields of the library (the program FIELDS, parameter_fields) and the structs of its headers. Without --write it prints what differs and
ends by exit code 1."""

import difflib
import os
import re
import subprocess
import sys

STRUCTS = [
    ("DetectionLimits", "model/include/conelane/lane_detector.hpp", "limits of one call of a detector or planner"),
    ("DetectorOptions", "detectors/include/conelane/detectors.hpp", "options of `make_detector`"),
    ("PlannerOptions", "detectors/include/conelane/planner.hpp", "options of `make_planner`"),
    ("DrivableOptions", "detectors/include/conelane/drivable_lane.hpp", "options of `drivable`"),
    ("SolveLimits", "solvers/include/conelane/solve_report.hpp", "limits of a solver"),
    ("RldDetectorOptions", "detectors/include/conelane/rld_detector.hpp", "options of a detector made of an RLD solver"),
]


def output_of(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def commands_of(program, *path):
    """The names of sub-commands, in the order of the help."""
    text = output_of(program, *path, "--help")
    _, found, below = text.partition("\nSubcommands:\n")
    return re.findall(r"^  (\S+)", below, flags=re.M) if found else []


def commands_page(program):
    lines = ["# Commands of the program", "",
             "Every command with its options: type, range and default. Made by `tests/docs/reference_pages --write` from `conelane COMMAND --help`; a test",
             "compares them. What each command is for: [program.md](program.md). `FLOAT=400` means: a number, 400 without the option.", ""]
    for name in commands_of(program):
        below = commands_of(program, name)
        lines += [f"## {name}", "", "```text", output_of(program, name, "--help").strip(), "```", ""]
        for other in below:
            lines += [f"### {name} {other}", "", "```text", output_of(program, name, other, "--help").strip(), "```", ""]
    return "\n".join(line.rstrip() for line in "\n".join(lines).split("\n"))


def cell(text):
    return text.replace("|", "\\|")


def members_of(root, struct, header):
    """(type, name, default, description) of each data member of a struct in a header."""
    with open(os.path.join(root, header), encoding="utf-8") as stream:
        text = stream.read()
    body = re.search(rf"^struct {struct} {{\n(.*?)^}};", text, flags=re.M | re.S).group(1)
    members, above, last = [], [], None
    for line in body.split("\n"):
        comment = re.match(r"\s*///\s?(?!<)(.*)", line)
        goes_on = re.match(r"\s*///<\s?(.*)", line)
        member = re.match(r"\s*([\w:<>, ]+?)\s+(\w+)\s*(?:=\s*([^;]+?)|\{([^}]*)\})?;\s*(?:///<\s?(.*))?$", line)
        if goes_on and last:
            last[3] += " " + goes_on.group(1)
        elif comment:
            above.append(comment.group(1))
        elif member:
            kind, name, equal, braced, beside = member.groups()
            default = equal if equal is not None else braced
            if default and default.endswith("::infinity()"):
                default = "infinity"
            last = [kind, name, "none" if default in ("{}", "", None) else default, " ".join(above + ([beside] if beside else []))]
            members.append(last)
            above = []
        else:
            above, last = [], None
    return members


def parameters_page(root, fields):
    groups = {}
    for line in output_of(fields).splitlines():
        group, *row = line.split("\t")
        groups.setdefault(group, []).append(row)
    sets = [group for group in groups if group.startswith("set ")]

    def number_table(group):
        rows = ["| parameter | type | default | range | unit | meaning |", "| --- | --- | --- | --- | --- | --- |"]
        for key, value, low, high, unit, meaning in groups[group]:
            rows.append(f"| `{key}` | number | {value} | {low} to {high} | {'–' if unit == '1' else unit} | {cell(meaning)} |")
        return rows

    lines = ["# Parameters", "", "Type, range, default and unit of every parameter. Made by `tests/docs/reference_pages --write` from the code; a test compares them.",
             "Options of the program: [commands.md](commands.md).", "", "## RLD", "",
             "The symbols of the RLD paper ([formulation.md](../model/formulation.md)). The keys are those of a [parameter file](formats.md#rld-parameters)", "and of Python's `parameters`.", ""]
    lines += number_table("rld")
    lines += ["| `pairing` | name | near_far | near_far, paper | – | which ends a path may join |", "", "Extras, off by default: costs of colours, confidences and the shape of the lane.", ""]
    lines += number_table("rld extra")
    lines += ["| `use_confidence` | true or false | false | | – | the benefit of an edge is `w_b` times the confidences of its cones |",
              "| `forbid_crossing` | true or false | false | | – | no two edges cross |",
              "| `learned_costs` | file | none | | – | costs that `conelane train rld` has learned, added to the others |", "", "### Shipped sets", "",
              "`--params NAME`, `rld_parameter_set(NAME)` or `parameters=\"NAME\"`. Only rows where a set differs from the defaults:", "",
              "| parameter | default | " + " | ".join(f"`{name[4:]}`" for name in sets) + " |", "| --- | --- |" + " --- |" * len(sets)]
    defaults = groups["rld"] + groups["rld extra"]
    for number, (key, value, *_) in enumerate(defaults):
        values = [groups[name][number][1] for name in sets]
        if any(other != value for other in values):
            lines.append(f"| `{key}` | {value} | " + " | ".join(values) + " |")
    for group in (name for name in groups if name.startswith("tuned ")):
        name = group[6:]
        lines += ["", f"## {name}", "", f"Tuned by `conelane tune-method {name}`; the default is the shipped value.", ""] + number_table(group)
    lines += ["", "## Options of the C++ library", "", "Units are in the names: `_ms`, `_m`, `_s`. Python has the same names as keyword arguments.", ""]
    for struct, header, what in STRUCTS:
        lines += [f"### {struct}", "", f"[{os.path.basename(header)}](../{header}): {what}.", "", "| option | type | default | meaning |", "| --- | --- | --- | --- |"]
        for kind, name, default, meaning in members_of(root, struct, header):
            lines.append(f"| `{name}` | `{cell(kind)}` | `{cell(default)}` | {cell(meaning)} |")
        lines.append("")
    return "\n".join(lines)


def main():
    root, program, fields, *options = sys.argv[1:]
    differ = False
    for name, page in (("commands.md", commands_page(program)), ("parameters.md", parameters_page(root, fields))):
        path = os.path.join(root, "docs", name)
        page = page.rstrip("\n") + "\n"
        stored = ""
        if os.path.exists(path):
            with open(path, encoding="utf-8") as stream:
                stored = stream.read()
        if stored == page:
            continue
        if "--write" in options:
            with open(path, "w", encoding="utf-8") as stream:
                stream.write(page)
            print(f"wrote docs/{name}")
        else:
            differ = True
            print("".join(list(difflib.unified_diff(stored.splitlines(True), page.splitlines(True), f"docs/{name}", "the code"))[:60]))
            print(f"docs/{name} is not up to date: tests/docs/reference_pages --write")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
