"""reference_pages.py ROOT PROGRAM FIELDS FOLDER: FOLDER/commands.md from the --help of the program, FOLDER/parameters.md from the
parameter fields of the library (the program FIELDS, parameter_fields) and the structs of its headers. Ends by exit code 1, with a line
for each, if a command, an option or a parameter has no description."""

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
    """The names of sub-commands, in the order of the help, whatever its groups are called."""
    text, group, names = output_of(program, *path, "--help"), "", []
    for line in text.split("\n"):
        heading = re.fullmatch(r"(\S.*):", line)
        group = heading.group(1) if heading else group
        entry = re.match(r"  ([a-z]\S*)", line)
        if entry and group and group not in ("Options", "Positionals"):
            names.append(entry.group(1))
    return names


def undescribed(command, text):
    """The command itself and its options, if they have no description. Descriptions begin in column 30, in a group 32; below long options."""
    lines = text.strip().split("\n")
    if lines[0].startswith("Usage:"):
        yield command
    for entry in re.findall(r"^ {2,4}-.*(?:\n {6,}.*)*", "\n".join(lines), flags=re.M):
        option, *below = entry.split("\n")
        wrapped = any(re.match(r" {6}\S", line) for line in below)
        if not any(re.match(r" {30,32}\S", line) for line in below) and (wrapped or not re.match(r".{29} \S|    .{27} \S", option)):
            yield f"{command} {option.strip()}"


def commands_page(program, missing):
    lines = ["# Commands of the program", "", "Every command with its options: type, range and default, made from `conelane COMMAND --help`.", ""]

    def add(level, *path):
        text = output_of(program, *path, "--help")
        missing.extend(undescribed(" ".join(path), text))
        lines.extend([f"{level} {' '.join(path)}", "", "```text", text.strip(), "```", ""])

    for name in commands_of(program):
        add("##", name)
        for other in commands_of(program, name):
            add("###", name, other)
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


def parameters_page(root, folder, fields, missing):
    sources = os.path.relpath(root, folder)
    groups = {}
    for line in output_of(fields).splitlines():
        group, *row = line.split("\t")
        groups.setdefault(group, []).append(row)
    sets = [group for group in groups if group.startswith("set ")]

    def number_table(group):
        rows = ["| parameter | type | default | range | unit | meaning |", "| --- | --- | --- | --- | --- | --- |"]
        for key, value, low, high, unit, meaning in groups[group]:
            missing.extend([] if meaning else [f"{group} {key}"])
            rows.append(f"| `{key}` | number | {value} | {low} to {high} | {'–' if unit == '1' else unit} | {cell(meaning)} |")
        return rows

    lines = ["# Parameters", "", "Type, range, default and unit of every parameter, made from the code. Options of the program: [commands.md](commands.md).", "", "## RLD", "",
             f"The symbols of the RLD paper ([formulation.md]({sources}/model/formulation.md)). The keys are those of a [parameter file]({sources}/docs/formats.md#rld-parameters)", "and of Python's `parameters`.", ""]
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
    lines += ["", "## Options of the C++ library", "", "Units are in the names: `_ms`, `_m`, `_s`. Python has the same names as keyword arguments; the values of `drivable` are given to `Planner` itself.", ""]
    for struct, header, what in STRUCTS:
        lines += [f"### {struct}", "", f"[{os.path.basename(header)}]({sources}/{header}): {what}.", "", "| option | type | default | meaning |", "| --- | --- | --- | --- |"]
        for kind, name, default, meaning in members_of(root, struct, header):
            missing.extend([] if meaning else [f"{struct}::{name}"])
            lines.append(f"| `{name}` | `{cell(kind)}` | `{cell(default)}` | {cell(meaning)} |")
        lines.append("")
    return "\n".join(lines)


def main():
    root, program, fields, folder = sys.argv[1:]
    missing = []
    pages = {"commands.md": commands_page(program, missing), "parameters.md": parameters_page(root, folder, fields, missing)}
    os.makedirs(folder, exist_ok=True)
    for name, page in pages.items():
        with open(os.path.join(folder, name), "w", encoding="utf-8") as stream:
            stream.write(page.rstrip("\n") + "\n")
        print(f"wrote {os.path.join(folder, name)}")
    missing += [] if "\n## compare\n" in pages["commands.md"] else ["compare: the help lists no commands"]
    planted = f"Usage: x\n\nOptions:\n  --a TEXT:{{tight,paper}}=tight\n  --b FLOAT:POSITIVE=400\n{'below':>35}\n{'  --c':30}beside"
    missing += [] if list(undescribed("x", planted)) == ["x", "x --a TEXT:{tight,paper}=tight"] else ["planted options are not found"]
    print("".join(f"no description: {name}\n" for name in missing), end="")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
