"""Warm start along a lap

Claim: What does the last scene's lane graph save an exact solver?
Protocol: each backend twice on the same scenes in travel order, without and with the start. Ratio: geometric mean of \
the time with it divided by the time without, scene by scene; below 1, the start saves time. False positives are drawn at \
every pose.
Source: this project; the RLD paper builds its model once and updates it.
Command: conelane study backends --warm-start --scenes RESULTS/scenes.scenes.jsonl --out RESULTS/backends.jsonl
"""

from .. import measures, solves
from ..experiment import Missing
from ..tables import Cell, Column, table, text


def html(results, published):
    stored = solves.read(results)
    cold = {(one.nearest, one.backend): one for one in stored if not one.is_warm}
    rows = []
    for warm in (one for one in stored if one.is_warm):
        start = cold.get((warm.nearest, warm.cold_backend))
        ratio = measures.latency_ratio(warm, start) if start else None
        if not ratio:
            continue
        mean, interval, count = ratio
        nodes, cold_nodes = float(warm.nodes.mean()), float(start.nodes.mean())
        rows.append([Cell(str(warm.nearest), warm.nearest), text(warm.cold_backend),
                     Cell(f"{mean:.2f}", mean, f"{interval[0]:.2f}–{interval[1]:.2f}" if interval else ""),
                     Cell(f"{cold_nodes:.1f}", cold_nodes), Cell(f"{nodes:.1f}", nodes), Cell(str(count), count)])
    if not rows:
        raise Missing("no backend was run with and without a start.")
    columns = [Column("n"), Column("backend", "text"), Column("time ratio"), Column("nodes without"),
               Column("nodes with"), Column("scenes")]
    return table("warm-start", "", columns, rows, note=f"Small: 95 % interval, tracks resampled.{stored[0].origin}")
