"""The tuned parameters of RLD: a table of the figures in the records beside the sets."""

import os

from cells import percent, read_json, table

SETS = {"n12": "12 cones", "context": "among 24", "shape": "among 24, costs of the shape, weights by `--rounds`"}


def tables(root):
    """The text of each table by its name."""
    lines = []
    for name, label in SETS.items():
        record = read_json(os.path.join(root, "detectors", "parameters", f"{name}.record.json"))
        lines.append([label] + [" / ".join(percent(share) for share in record[figures]["by_rate"].values())
                                for figures in ("figures_of_start", "held_out_figures")] + [f"`{name}`"])
    lines.append(["RLD paper (its generated scenes)", "", "– / 96.4 / above 90", ""])
    return {"parameters of RLD": table(["", "untuned", "tuned, held out", "set"], lines)}
