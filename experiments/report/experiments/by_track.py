"""Usable lanes by track

Claim: How much does the share of usable lanes depend on the track?
Protocol: share of usable lanes (success in results of earlier versions), all rates and ranges of a track together.
Source: this project.
Command: conelane compare --out RESULTS
"""

import numpy as np

from ..leaders import headline_values
from ..tables import Cell, Column, percent, table, text


def _cell(share, is_trained):
    cell = percent(share)
    return Cell(cell.text, cell.value, "trained") if is_trained and share is not None else cell


def html(results, published):
    values_of = headline_values(results.samples)
    tracks = sorted(set().union(*(set(sample.track) for sample in results.samples)))
    trained = {sample.label: set(sample.track[sample.trained_on == 1.0]) for sample in results.samples}
    rows, attributes = [], []
    for condition in results.conditions:
        shares, counts = [], {}
        for sample in results.samples:
            values, track_of = values_of(sample.at(condition=condition))
            found = {}
            for scene, value in values.items():
                found.setdefault(track_of[scene], []).append(value)
            for track, of_track in found.items():
                counts[track] = max(counts.get(track, 0), len(of_track))
            shares.append({track: float(np.mean(of_track)) for track, of_track in found.items()})
        for track in tracks:
            if any(track in of_method for of_method in shares):
                under = [text(condition)] if results.conditions != [""] else []
                cells = [_cell(of_method.get(track), track in trained[sample.label])
                         for sample, of_method in zip(results.samples, shares)]
                rows.append([text(track)] + under + [Cell(str(counts[track]), counts[track])] + cells)
                attributes.append({"condition": condition})
    columns = [Column("track", "text")] + ([Column("condition", "text")] if results.conditions != [""] else [])
    return table("by-track", "", columns + [Column("scenes")] + [Column(sample.label + " %") for sample in results.samples], rows,
                 row_attributes=attributes, note="Trained: the method has learned from this course: no held-out figure."
                 if any(trained.values()) else "")
