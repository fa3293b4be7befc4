"""The shipped weights, which are not held out: the figures of the runs of experiments/tables/shipped, and their tables."""

import os

from cells import lines_of, over, pair, percent, provenance, read_json, rounded, table, version_of
from races import race_rows

SETS = [31, 41]
RATES = [0.0, 0.1, 0.3, 0.5]
COLOURS = {"none": "none", "usual": "5 % wrong, 20 % unknown", "half_unknown": "10 % wrong, 50 % unknown", "wrong": "30 % wrong"}
NOISES = ["0.01", "0.02"]
MISSIONS = ["acceleration", "skidpad"]
CONDITIONS = {"car": "`car`", "colors": "`car --colors`", "no_ids": "`car --ids none`", "harsh": "`harsh`"}


def score_rows(path):
    """The figures of front by rate and range."""
    return [{"rate": line["false_positive_rate"], "range": line["range"], "scenes": line["scenes"], "usable": rounded(line["usable_share"]),
             "iou": rounded(line["mean_iou"]), "trusted": rounded(line["calibration"]["trusted_share"]),
             "right_if_trusted": rounded(line["calibration"]["right_where_trusted_share"])} for line in lines_of(path)]


def collect(folder):
    runs = os.path.join(folder, "shipped")
    stored = {"runs": {"colours": version_of(os.path.join(runs, "version.txt"))}, "rows": [], "races": []}
    for name in [f"colours_{name}" for name in COLOURS] + [f"{known}_{noise}" for noise in NOISES for known in ("unknown", "known")]:
        for drawn in SETS:
            stored["rows"] += [{"run": name, "set": drawn} | row for row in score_rows(os.path.join(runs, f"{name}.{drawn}.json"))]
    for mission in MISSIONS:
        for name in CONDITIONS:
            record = read_json(os.path.join(runs, f"{mission}_{name}", "race.json"))
            stored["runs"][f"{mission}_{name}"] = provenance(record)
            stored["races"] += [{"mission": mission, "run": name} | row for row in race_rows(record)]
    return stored


def together(rows):
    """The mean of each share, weighted by scenes."""
    return {"scenes": sum(row["scenes"] for row in rows)} | {key: over(rows, key) for key in ("usable", "iou", "trusted", "right_if_trusted")}


def selected(stored, run, **values):
    return [row for row in stored["rows"] if row["run"] == run and all(row[key] == value for key, value in values.items())]


def colour_table(stored):
    lines = []
    for name, label in COLOURS.items():
        run = f"colours_{name}"
        whole = together(selected(stored, run))
        cells = [together(selected(stored, run, rate=rate)) for rate in RATES]
        lines.append([label] + [pair((cell["usable"], cell["iou"])) for cell in cells] +
                     [f"{percent(whole['right_if_trusted'])}, {percent(whole['trusted'], 0)}"])
    return table(["colours", *(f"{100 * rate:.0f} %" + (" false positives" if rate == 0.0 else "") for rate in RATES), "right where trusted, trusted"], lines)


def uncertainty_table(stored):
    lines = []
    for noise in NOISES:
        for drawn in SETS:
            for known in ("unknown", "known"):
                row = together(selected(stored, f"{known}_{noise}", set=drawn))
                lines.append([f"@{drawn}, @{drawn + 1}, {row['scenes']}" if known == "unknown" else "", noise if known == "unknown" else "", known,
                              percent(row["usable"]), percent(row["iou"]), percent(row["right_if_trusted"]), percent(row["trusted"], 0)])
    return table(["courses, scenes", "K", "covariances", "usable, %", "IoU, %", "right where trusted, %", "trusted, %"], lines)


def mission_table(stored):
    lines = []
    for name, label in CONDITIONS.items():
        line = [label]
        for mission in MISSIONS:
            rows = sorted((row for row in stored["races"] if (row["mission"], row["run"]) == (mission, name)), key=lambda row: row["rate"])
            line.append(" / ".join(f"{row['finished'] * row['races']:.0f}" for row in rows))
        for mission in MISSIONS:
            said = [row["stop_said_m"] for row in stored["races"] if (row["mission"], row["run"]) == (mission, name) and row["stop_said_m"]]
            line.append(f"{min(low for low, _, _ in said):.1f} to {max(high for _, _, high in said):.1f}" if said else "–")
        lines.append(line)
    races = max(row["races"] for row in stored["races"])
    return table(["", *(f"{mission}, of {races}" for mission in MISSIONS), *(f"stop said, {mission}, m" for mission in MISSIONS)], lines)


TABLES = {"colours": colour_table, "uncertain positions": uncertainty_table, "missions": mission_table}


def tables(stored):
    """The text of each table by its name."""
    return {name: make(stored) for name, make in TABLES.items()}
