"""Success by track

Claim: Does a method's success hang on the track?
Protocol: all rates and ranges of a track together.
Source: this project.
Command: conelane compare --out RESULTS
"""

from ..tables import Column, percent, table, text


def html(results, published):
    tracks = sorted({track for sample in results.samples for track in sample.track})
    rows = []
    for track in tracks:
        parts = [sample.where(sample.track == track) for sample in results.samples]
        rows.append([text(track)] + [percent(part.success.mean() if len(part) else None) for part in parts])
    return table("by-track", "", [Column("track", "text")] + [Column(s.label + " %") for s in results.samples], rows)
