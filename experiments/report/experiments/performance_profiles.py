"""Performance profiles

Claim: Which exact method is fastest on most scenes, and how far behind are the others?
Protocol: Dolan and Moré: the share of scenes that a method solves (it proves the optimum, or that there is \
no lane) within a multiple of the fastest method's time on the same scene. Height at 1: how often it is the fastest. Methods of the same cone set and \
the same objective only; \
a scene without a proof after 0.4 s counts as unsolved. If the methods of the comparison saw different cone sets, \
those of the sweep are shown.
Source: Dolan and Moré, Benchmarking optimization software with performance profiles, 2002.
Command: conelane compare --methods rld-cbc,rld-pair --nearest 12 --out RESULTS
"""

import numpy as np

from .. import measures
from ..experiment import Missing
from ..figures import drawn, group, name_of_set
from ..theme import legend, logarithmic, method_style, new_figure

_SWEEP_SIZES = (12, 30)


def profile_figure(labels, styles, times):
    """`times`: (scenes, methods), infinite where unsolved."""
    ratios = measures.performance_profiles(times)
    figure, axes = new_figure()
    finite = ratios[np.isfinite(ratios)]
    most = max(2.0, finite.max() if len(finite) else 2.0)
    places = np.geomspace(1.0, most, 200)
    for i, (label, style) in enumerate(zip(labels, styles)):
        shares = np.searchsorted(ratios[:, i], places, side="right") / len(times)
        axes.step(places, 100 * shares, where="post", label=label, **style | {"marker": ""})
    axes.set_xscale("log")
    ticks = (1, 2, 5, 10, 20, 50, 100) if most <= 200 else 10.0 ** np.arange(7)
    axes.set_xticks([tick for tick in ticks if tick <= most])
    logarithmic(axes.xaxis)
    axes.set_xlabel("time / fastest method's time on the same scene")
    axes.set_ylabel("scenes solved [%]")
    axes.set_ylim(-2, 103)
    legend(axes)
    return figure


def _of_one_problem(results):
    """Samples that prove optimality of one objective on one cone set, two or more: of the comparison, else of the
    sweep."""
    found = {}
    for samples, sizes in ((results.samples, None), (results.sweep, _SWEEP_SIZES)):
        known = {nearest for nearest, _ in found}
        for sample in samples:
            if sample.has("solved") and (sizes is None or (sample.nearest in sizes and sample.nearest not in known)):
                found.setdefault((sample.nearest, results.objective_of(sample)), []).append(sample)
        found = {problem: of_one for problem, of_one in found.items() if len(of_one) > 1}
    return [(nearest, samples) for (nearest, _), samples in found.items()]


def html(results, published):
    figures, of_set = [], {}
    for nearest, samples in _of_one_problem(results):
        scenes = sorted(set.intersection(*(set(sample.scene) for sample in samples)))
        if not scenes:
            continue
        columns = []
        for sample in samples:
            times = dict(zip(sample.scene, np.where(sample.solved == 1.0, sample.latency, np.inf)))
            columns.append([times[scene] for scene in scenes])
        figure = profile_figure([sample.label for sample in samples],
                                [method_style(results.methods, sample.method) for sample in samples],
                                np.array(columns).T)
        of_set[nearest] = of_set.get(nearest, 0) + 1  # one for each objective
        name = f"profile-{nearest or 'all'}" + (f"-{of_set[nearest]}" if of_set[nearest] > 1 else "")
        figures.append(drawn(name, f"The upper left curve is the fastest on most scenes, a curve that ends below 100 % "
                             f"left some unproven. On {name_of_set(nearest)}, {len(scenes)} scenes.", figure))
    if not figures:
        raise Missing("no two methods prove optimality of one objective on the same cone sets.")
    return group(figures) if len(figures) > 1 else figures[0]
