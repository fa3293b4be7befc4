"""Exact backends

Claim: All exact solvers have the same optimum; they differ in time.
Protocol: every backend on the same cone sets of the same scenes, one thread, pinned; the time is from the scene in \
memory to the lane graph in memory, the program's building included. Every lane graph passes the independent checker \
or counts as an error. Time-outs count in every figure with the time that they took.
Source: this project; the RLD paper runs Mosek on the printed formulation.
Published: mean 71.79 ms, 95 % within 155.88 ms at n = 12, on another machine.
Command: conelane study backends --sizes 12,20,30,60,all --scenes RESULTS/scenes.scenes.jsonl --out RESULTS/backends.jsonl
"""

import numpy as np

from .. import measures, solves
from ..experiment import Missing
from ..figures import drawn, group
from ..tables import Cell, Column, milliseconds, percent, table, text
from ..theme import series_style
from .performance_profiles import profile_figure


def _rows(of_size):
    rows = []
    for one in of_size:
        rows.append([Cell(solves.size_name(one.nearest), solves.size_order(one.nearest)), text(one.backend), Cell(str(len(one)), len(one)),
                     percent(one.is_decided.mean()),
                     Cell(str(int(np.sum(one.status == "error"))), int(np.sum(one.status == "error"))),
                     milliseconds(float(np.median(one.latency)),
                                  interval=measures.median_interval(one.latency, one.track)),
                     milliseconds(one.latency.mean()), milliseconds(one.latency.std(ddof=1) if len(one) > 1 else 0.0),
                     milliseconds(measures.shifted_geometric_mean(one.latency)),
                     milliseconds(measures.quantile(one.latency, 0.95)),
                     milliseconds(measures.quantile(one.latency, 0.99)), milliseconds(one.latency.max()),
                     Cell(f"{one.nodes.mean():.1f}", float(one.nodes.mean()))])
    return rows


def html(results, published):
    cold = [one for one in solves.read(results) if not one.is_warm]
    if not cold:
        raise Missing(f"there is no {solves.FILE}.")
    rows, figures, agreement = [], [], []
    for size in dict.fromkeys(one.nearest for one in cold):
        of_size = [one for one in cold if one.nearest == size]
        rows += _rows(of_size)
        apart, shared = solves.disagreements(of_size)
        agreement.append(f"n = {solves.size_name(size)}: {apart} of {shared} scenes")
        scenes = sorted(set.intersection(*(set(one.scene) for one in of_size)))
        if len(of_size) < 2 or not scenes:
            continue
        columns = []
        for one in of_size:
            times = dict(zip(one.scene, np.where(one.is_decided, one.latency, np.inf)))
            columns.append([times[scene] for scene in scenes])
        figure = profile_figure([one.backend for one in of_size], [series_style(i) for i in range(len(of_size))],
                                np.array(columns).T)
        figures.append(drawn(f"backends-profile-{solves.size_name(size)}", f"The upper left curve is the fastest backend on most scenes. Share of {len(scenes)} scenes proven (optimum or no lane) "
                             "within a multiple of the fastest backend's time.", figure, f"n = {solves.size_name(size)}"))
    columns = [Column("n"), Column("backend", "text"), Column("scenes"), Column("proven %"), Column("errors"),
               Column("median ms"), Column("mean ms"), Column("standard deviation ms"), Column("geometric mean ms"),
               Column("p95 ms"), Column("p99 ms"), Column("max ms"), Column("nodes")]
    return group(figures) + table("backends", "", columns, rows,
                                  note=f"Backends prove different optima at {'; '.join(agreement)}. Small: 95 % "
                                  f"interval, tracks resampled. Geometric mean: shifted by 1 ms.{cold[0].origin}")
