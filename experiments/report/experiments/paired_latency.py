"""Paired latencies

Claim: By what factor do methods of the same cone set differ in time on the same scene?
Protocol: geometric mean over scenes of a method's time divided by that of the method with the least \
geometric mean on the same cone set, of the comparison and of the sweep; 2.00 is twice the time. 95 % bootstrap \
interval, tracks resampled.
Source: this project.
Command: conelane compare --methods rld-cbc,rld-paper --out RESULTS
"""

from .. import measures
from ..experiment import Missing
from ..leaders import fastest_of
from ..tables import Cell, Column, method_cell, table, text


def _of_one_set(results):
    """Samples by cone-set size, two or more: of the comparison, then of the sweep where that has none."""
    found = {}
    for sample in results.samples:
        found.setdefault(sample.nearest, []).append(sample)
    found = {nearest: samples for nearest, samples in found.items() if len(samples) > 1}
    for size in sorted({sample.nearest for sample in results.sweep} - set(found)):
        found[size] = [sample for sample in results.sweep if sample.nearest == size]
    return [samples for samples in found.values() if len(samples) > 1]


def html(results, published):
    rows = []
    for samples in _of_one_set(results):
        fastest = fastest_of(samples)
        for sample in samples:
            ratio = None if sample is fastest else measures.latency_ratio(sample, fastest)
            if ratio:
                mean, interval, count = ratio
                small = f"{interval[0]:.2f}–{interval[1]:.2f}" if interval else ""
                rows.append([method_cell(results.methods, sample.method, sample.label), text(fastest.label),
                             Cell(f"{mean:.2f}", mean, small), Cell(str(count), count)])
    if not rows:
        raise Missing("no two methods saw the same cone sets.")
    columns = [Column("method", "text"), Column("against", "text"), Column("time ratio"),
               Column("scenes of both")]
    return table("ratios", "", columns, rows, note="Small: 95 % interval.")
