"""Centre line and steadiness

Claim: How near is the centre line of a usable lane to the true one, and how steady is it from pose to pose?
Protocol: centre lines of usable lanes compared with the ground truth's over the first 20 m: distance at every half metre, \
heading at 10 m. Unsteady: share of poses whose centre line differs by more than 0.5 m anywhere over the first 15 m \
from that of the pose before; a pose without a lane counts as unsteady.
Source: this project.
Command: conelane compare --out RESULTS
"""

from ..experiment import Missing
from ..rows import attributes, key_cells, keys
from ..tables import Column, degrees, metres, percent, table


def html(results, published):
    if not any("lateral_median_m" in row or "unsteady_share" in row for row in results.rows):
        raise Missing("no lane was compared with a true centre line.")
    rows = [key_cells(results, row) + [percent(row.get("usable_share"))] +
            [metres(row.get(key), measure=key) for key in ("lateral_median_m", "lateral_p95_m")] +
            [degrees(row.get(key), measure=key) for key in ("heading_median_rad", "heading_p95_rad")] +
            [percent(row.get("unsteady_share"), measure="unsteady_share")] for row in results.rows]
    columns = keys(results) + [Column("usable %"), Column("lateral median m"), Column("lateral p95 m"),
                               Column("heading median °"), Column("heading p95 °"), Column("unsteady %")]
    return table("steering", "", columns, rows, row_attributes=attributes(results))
