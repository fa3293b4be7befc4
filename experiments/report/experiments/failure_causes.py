"""Why lanes are not usable

Claim: What is the first error in lanes that are not usable?
Protocol: every lane that is not usable, all rates and ranges together, by the first place where it leaves the truth. \
If a lane diverges within 20 m, this place is its first vertex off the annotated boundary. Wrong start: the first vertex \
of its side. False cone taken: a cone on no boundary of the course. Wrong leg: a cone of another stretch of the course. \
Wrong side: a cone of the opposite boundary of this stretch. Cone skipped: a later cone of its own boundary, so cones \
before it were left out. A lane that is too short stopped early, or before a gap, a step longer than one and a half times the \
median step of the ground truth; it has a wrong start if most of the missing length is before it. Leaves the path: \
only a driven path, or a centre line without boundaries, is known, which does not show the cause.
Source: this project.
Command: conelane compare --out RESULTS
"""

import numpy as np

from ..experiment import Missing
from ..load import CAUSES
from ..tables import Cell, Column, method_cell, percent, table, text


def html(results, published):
    rows, attributes = [], []
    seen = [cause for cause in CAUSES if any(np.any(sample.cause == cause) for sample in results.samples)]
    if not seen:
        raise Missing("no score names a cause.")
    for condition in results.conditions:
        for sample in results.samples:
            part = sample.at(condition=condition).known("usable")
            if not len(part):
                continue
            unusable = int(np.sum(part.usable == 0.0))
            under = [text(condition)] if results.conditions != [""] else []
            cells = [method_cell(results.methods, sample.method, sample.label)] + under + [
                Cell(str(len(part)), len(part)), Cell(str(unusable), unusable), percent(unusable / len(part), measure="not_usable")]
            for cause in seen:
                count = int(np.sum(part.cause == cause))
                share = percent(count / unusable if unusable else None, measure=cause)
                cells.append(Cell(share.text, share.value, str(count) if count else "", share.attributes))
            rows.append(cells)
            attributes.append({"method": sample.label, "condition": condition})
    columns = [Column("method", "text")] + ([Column("condition", "text")] if results.conditions != [""] else []) + [
        Column("scenes"), Column("not usable"), Column("of all scenes %")] + [Column(f"{CAUSES[cause]} %") for cause in seen]
    return table("failure-causes", "", columns, rows, row_attributes=attributes,
                 note="Causes in per cent of the scenes that are not usable; small: their number.")
