"""RLD Fig. 7: inaccurate lanes by topology

Claim: Few lanes are inaccurate, whatever the topology, up to as many false positives as cones.
Protocol: methods that saw the 12 nearest cones, on tracks called straight, circle and curvy; the share of scenes \
where one of the paper's four checks fails. Its ratio 1:5 is 16.7 % of all points, 1:1 is 50 %. One scale for all \
topologies.
Source: RLD paper, IV-B, Fig. 7: its own tracks; the parameters of its model are not printed.
Published: 3.62 % inaccurate at 1:5, less than 10 % at 1:1, all three topologies together.
Command: conelane compare --tracks generated:straight generated:circle generated:curvy --fp \
0,0.1667,0.2857,0.375,0.4444,0.5 --out RESULTS
"""

import numpy as np

from ..experiment import Missing
from ..figures import drawn, group, percent_label, variants
from ..theme import ACCENT, legend, method_style, new_figure

TOPOLOGIES = ("straight", "circle", "curvy")


def _topology(results, samples, topology, most, published):
    figure, axes = new_figure(height=2.7)
    for sample, variant in variants(samples):
        part = sample.where(sample.track == topology)
        points = [(100 * rate, 100 * (1 - part.at(rate).accurate.mean()))
                  for rate in results.rates if len(part.at(rate))]
        if points:
            axes.plot(*zip(*points), label=sample.label, **method_style(results.methods, sample.method, variant))
    axes.plot(*zip(*[(100 * row["rate"], row["inaccurate"]) for row in published["rld"]]), marker="*", markersize=11,
              linestyle="", color=ACCENT, label="RLD paper, all three (1:1 is a bound)")
    ticks = sorted({round(rate, 4) for rate in results.rates} | {round(row["rate"], 4) for row in published["rld"]})
    axes.set_xticks([100 * rate for rate in ticks], [percent_label(rate) for rate in ticks])
    axes.set_ylim(0, 1.06 * most)
    axes.set_xlabel("false positives [% of all points]")
    axes.set_ylabel("inaccurate [%]")
    legend(axes)
    return drawn(f"rld-fig-7-{topology}", "Below the stars is better than the paper.", figure, topology.capitalize())


def html(results, published):
    size = published["rld_cone_set"]
    samples = [s.known("accurate") for s in results.samples if s.nearest == size]
    present = [topology for topology in TOPOLOGIES if any(topology in s.track for s in samples)]
    if not present:
        raise Missing(f"no method with n = {size} ran on a track called {', '.join(TOPOLOGIES[:-1])} or "
                      f"{TOPOLOGIES[-1]}.")
    parts = [s.where((s.track == topology) & (s.rate == rate)) for s in samples for topology in present
             for rate in results.rates]
    most = max([row["inaccurate"] for row in published["rld"]] +
               [100 * (1 - part.accurate.mean()) for part in parts if len(part)])
    return group([_topology(results, samples, topology, most, published) for topology in present])
