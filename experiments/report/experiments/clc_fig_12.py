"""CLC Fig. 12: lane lengths

Claim: Lanes are as long as the ground truth.
Protocol: filled: the ground truth (12a). Lines: lanes that do not diverge (12b). Rates up to 30 %, bins of 5 m, in \
per cent of all scenes.
Source: CLC paper, VIII-D, Fig. 12.
Published: a picture; lanes of up to 100 m, some of 150 m.
Command: conelane compare --out RESULTS
"""

import numpy as np

from ..clc_rows import moderate, of_paper
from ..experiment import Missing
from ..figures import drawn, variants
from ..theme import INK, legend, method_color, method_style, new_figure


def html(results, published):
    samples = [sample for sample in map(moderate, results.samples) if len(sample)]
    if not samples:
        raise Missing("there is no scene with a rate up to 30 %.")
    figure, axes = new_figure()
    bins = np.arange(0.0, max(max(s.lane_length.max(), s.ground_truth_length.max()) for s in samples) + 5.0, 5.0)
    truth = max(samples, key=len)
    counts, _ = np.histogram(truth.ground_truth_length, bins)
    axes.stairs(100 * counts / len(truth), bins, fill=True, color=INK, alpha=0.16, label="ground truth")
    for sample, variant in variants(samples):
        kept = sample.where(np.isin(sample.category, ("ground_truth", "near_ground_truth", "too_short")))
        counts, _ = np.histogram(kept.lane_length, bins)
        axes.stairs(100 * counts / len(sample), bins, label=sample.label, linewidth=1.4, gid=f"curve:{sample.method}",
                    color=method_color(results.methods, sample.method),
                    linestyle=method_style(results.methods, sample.method, variant)["linestyle"])
    axes.set_xlabel("length [m]")
    axes.set_ylabel("of all scenes [%]")
    legend(axes)
    return drawn("clc-fig-12", "A line along the filled shape: the lanes are as long as the ground truth. Only lanes that do not diverge.", figure)


def verdict(results, published):
    """Lanes that do not diverge have 90 % of the ground truth's length, added up."""
    judged = []
    for sample in of_paper(map(moderate, results.samples)):
        kept = sample.where(np.isin(sample.category, ("ground_truth", "near_ground_truth", "too_short")))
        if len(kept):
            share = 100 * float(kept.lane_length.sum() / kept.ground_truth_length.sum())
            judged.append((sample.label, share >= 90, f"{share:.0f} % of the length"))
    return judged
