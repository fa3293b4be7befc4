"""RLD Fig. 7: inaccurate lanes by topology

Claim: Less than 10 % of the lanes are inaccurate, whatever the topology, up to as many false positives as cones.
Protocol: methods that saw the 12 nearest cones, on tracks called straight, circle and curvy; the share of scenes \
where one of the paper's four checks fails. Its ratio 1:5 is 16.7 % of all points, 1:1 is 50 %. One scale for all \
topologies.
Source: RLD paper, IV-B, Fig. 7: its own tracks; the parameters of its model are not printed.
Published: 3.62 % inaccurate at 1:5, less than 10 % at 1:1, all three topologies together.
Command: conelane compare --tracks generated:straight generated:circle generated:curvy --nearest 12 --fp \
0,0.1667,0.2857,0.375,0.4444,0.5 --out RESULTS/topologies
"""

import numpy as np

from ..experiment import Missing
from ..figures import drawn, group, percent_label, variants
from ..theme import ACCENT, legend, method_style, new_figure

TOPOLOGIES = ("straight", "circle", "curvy")


def _of(sample, topology):
    """Its scenes on tracks of a topology, whatever their seeds: straight, straight@1, ..."""
    return sample.where(np.array([track.partition("@")[0] == topology for track in sample.track], dtype=bool))


def _rates(samples):
    return sorted({rate for sample in samples for rate in sample.rate})


def _topology(results, samples, topology, most, published):
    figure, axes = new_figure(height=2.7)
    for sample, variant in variants(samples):
        part = _of(sample, topology)
        points = [(100 * rate, 100 * (1 - part.at(rate).accurate.mean()))
                  for rate in _rates(samples) if len(part.at(rate))]
        if points:
            axes.plot(*zip(*points), label=sample.label, **method_style(results.methods, sample.method, variant))
    axes.plot(*zip(*[(100 * row["rate"], row["inaccurate"]) for row in published["rld"]]), marker="*", markersize=11,
              linestyle="", color=ACCENT, label="RLD paper")
    ticks = sorted({round(rate, 4) for rate in _rates(samples)} | {round(row["rate"], 4) for row in published["rld"]})
    axes.set_xticks([100 * rate for rate in ticks], [percent_label(rate) for rate in ticks])
    axes.set_ylim(0, 1.06 * most)
    axes.set_xlabel("false positives [% of all points]")
    axes.set_ylabel("inaccurate [%]")
    legend(axes)
    return drawn(f"rld-fig-7-{topology}", "Below the stars, fewer lanes are inaccurate than in the paper. The paper's figures are for all topologies together; "
                 "at 50 % it gives a bound.",
                 figure, topology.capitalize())


def _stored(results, published):
    """The samples on the topologies, of the comparison beside or of this one, and the topologies that they have."""
    size = published["rld_cone_set"]
    for stored in (results.beside["topologies"], results.samples):
        samples = [s.known("accurate") for s in stored if s.nearest == size]
        present = [topology for topology in TOPOLOGIES if any(len(_of(s, topology)) for s in samples)]
        if present:
            return samples, present
    return [], []


def html(results, published):
    samples, present = _stored(results, published)
    if not present:
        raise Missing(f"no method with n = {published['rld_cone_set']} ran on a track called "
                      f"{', '.join(TOPOLOGIES[:-1])} or {TOPOLOGIES[-1]}.")
    parts = [_of(s, topology).at(rate) for s in samples for topology in present for rate in _rates(samples)]
    most = max([row["inaccurate"] for row in published["rld"]] +
               [100 * (1 - part.accurate.mean()) for part in parts if len(part)])
    return group([_topology(results, samples, topology, most, published) for topology in present])


def verdict(results, published):
    """No topology has more inaccurate lanes than the paper's bound, at any rate up to its highest."""
    bound, highest = max((row["inaccurate"], row["rate"]) for row in published["rld"])
    samples, present = _stored(results, published)
    judged = []
    for sample in samples:
        shares = {(topology, rate): 100 * float(1 - part.accurate.mean()) for topology in present for rate in _rates([sample])
                  if rate <= highest + 1e-9 and len(part := _of(sample, topology).at(rate))}
        if shares:
            (topology, rate), most = max(shares.items(), key=lambda pair: pair[1])
            judged.append((sample.label, most <= bound, f"{most:.1f} % inaccurate at most, on {topology} at "
                                                        f"{percent_label(rate)} %"))
    return judged
