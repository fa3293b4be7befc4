"""Usable lanes by track

Claim: Does it hang on the track whether a method's lane can be driven by?
Protocol: share of usable lanes (success in results of earlier versions), all rates and ranges of a track together.
Source: this project.
Command: conelane compare --out RESULTS
"""

import numpy as np

from ..leaders import headline_values
from ..tables import Column, percent, table, text


def html(results, published):
    values_of = headline_values(results.samples)
    tracks = sorted(set().union(*(set(sample.track) for sample in results.samples)))
    rows, attributes = [], []
    for condition in results.conditions:
        shares = []
        for sample in results.samples:
            values, track_of = values_of(sample.at(condition=condition))
            found = {}
            for scene, value in values.items():
                found.setdefault(track_of[scene], []).append(value)
            shares.append({track: float(np.mean(of_track)) for track, of_track in found.items()})
        for track in tracks:
            if any(track in of_method for of_method in shares):
                under = [text(condition)] if results.conditions != [""] else []
                rows.append([text(track)] + under + [percent(of_method.get(track)) for of_method in shares])
                attributes.append({"condition": condition})
    columns = [Column("track", "text")] + ([Column("condition", "text")] if results.conditions != [""] else [])
    return table("by-track", "", columns + [Column(sample.label + " %") for sample in results.samples], rows,
                 row_attributes=attributes)
