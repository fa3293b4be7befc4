"""Paired latencies

Claim: By what factor do methods of the same cone set differ in time on the same scene?
Protocol: geometric mean over scenes of a method's time divided by that of the method with the least shifted \
geometric mean on the same cone set; 2.00 is twice the time. 95 % bootstrap interval, tracks resampled.
Source: this project.
Command: conelane compare --methods rld-cbc,rld-paper --out RESULTS
"""

from .. import measures
from ..experiment import Missing
from ..tables import Cell, Column, method_cell, table, text


def html(results, published):
    rows = []
    for nearest in dict.fromkeys(sample.nearest for sample in results.samples):
        samples = [sample for sample in results.samples if sample.nearest == nearest]
        if len(samples) < 2:
            continue
        fastest = min(samples, key=lambda sample: measures.shifted_geometric_mean(sample.latency))
        for sample in samples:
            ratio = None if sample is fastest else measures.latency_ratio(sample, fastest)
            if ratio:
                mean, interval, count = ratio
                small = f"{interval[0]:.2f}–{interval[1]:.2f}" if interval else ""
                rows.append([method_cell(results.methods, sample.method, sample.label), text(fastest.label),
                             Cell(f"{mean:.2f}", mean, small), Cell(str(count), count)])
    if not rows:
        raise Missing("no two methods saw the same cone sets.")
    columns = [Column("method", "text"), Column("against the fastest", "text"), Column("time ratio"),
               Column("scenes of both")]
    return table("ratios", "", columns, rows, note="Small: 95 % interval.")
