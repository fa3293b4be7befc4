"""Outcomes of the scenes

Claim: How do methods fail, not only how often?
Protocol: the first category that fits: no lane, ground truth (exactly the same cones), diverging, too short (below 75 % of \
the ground truth's length), near (all other lanes, which do not diverge). All but none and diverging below 20 m are \
successes. Errors, a part of none: the method failed, or the independent checker rejected the answer of an RLD \
method; the checker recomputes every constraint, objective and bound from the scene.
Source: categories of the CLC paper, VIII-D; the checker is this project's.
Command: conelane compare --out RESULTS
"""

import numpy as np

from ..load import CATEGORIES
from ..rows import CATEGORY_NOTE, attributes, key_cells, keys, part
from ..tables import Cell, Column, percent, table

_TITLES = {"ground_truth": "ground truth %", "near_ground_truth": "near %", "too_short": "too short %",
           "diverging_from_20": "diverging ≥ 20 m %", "diverging_below_20": "diverging < 20 m %", "none": "none %"}


def _checks(scores):
    """Errors, and what the checker accepted of what it was given."""
    errors = int(np.sum(scores.status == "error"))
    cells = [Cell(str(errors), errors)]
    accepted = int(np.nansum(scores.checked))
    return cells + [Cell(str(accepted), accepted) if accepted else Cell("–")]


def html(results, published):
    rows = [key_cells(results, row) + [percent(row["share"].get(key), measure=key) for key in CATEGORIES] +
            _checks(part(results, row)) for row in results.rows]
    columns = keys(results) + [Column(_TITLES[key]) for key in CATEGORIES] + [Column("errors"), Column("checker accepts")]
    return table("categories", "", columns, rows, row_attributes=attributes(results),
                 note=CATEGORY_NOTE)
