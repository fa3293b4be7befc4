"""CLC Fig. 9: where lanes diverge

Claim: Most wrong lanes leave the track far from the car.
Protocol: distance along the boundary up to which a diverging lane is right, rates up to 30 %, bins of 5 m, in per \
cent of all scenes. Left of the line a divergence is critical.
Source: CLC paper, VIII-D, Fig. 9.
Published: a picture only; its sums are in Table I: 2.2 to 4.1 % diverge from 20 m on, 0.6 to 0.8 % before.
Command: conelane compare --out RESULTS
"""

import numpy as np

from ..clc_rows import moderate, of_paper
from ..experiment import Missing
from ..figures import drawn, variants
from ..theme import ACCENT, legend, method_color, method_style, new_figure


def html(results, published):
    samples = [moderate(sample).known("divergence") for sample in results.samples]
    total = {sample.label: len(moderate(sample)) for sample in results.samples}
    samples = [sample for sample in samples if len(sample)]
    if not samples:
        raise Missing("no lane diverges, or no annotated boundary was given.")
    figure, axes = new_figure()
    most = max(sample.divergence.max() for sample in samples)
    bins = np.arange(0.0, most + 5.0, 5.0) if most > 0 else np.array([0.0, 5.0])
    for sample, variant in variants(samples):
        counts, _ = np.histogram(sample.divergence, bins)
        axes.stairs(100 * counts / total[sample.label], bins, label=sample.label, linewidth=1.4, gid=f"curve:{sample.method}",
                    color=method_color(results.methods, sample.method),
                    linestyle=method_style(results.methods, sample.method, variant)["linestyle"])
    axes.axvline(20, color=ACCENT, linewidth=1)
    axes.set_xlabel("divergence distance [m]")
    axes.set_ylabel("of all scenes [%]")
    legend(axes)
    return drawn("clc-fig-9", "Divergence left of the line, at 20 m, is critical: a low curve there is good. Rates up to 30 %, bins of 5 m.", figure)


def verdict(results, published):
    """Most of the lanes that go wrong do so from 20 m on."""
    judged = []
    for sample in of_paper(map(moderate, results.samples)):
        wrong = sample.known("divergence")
        if len(wrong):
            share = 100 * float(np.mean(wrong.category == "diverging_from_20"))
            judged.append((sample.label, share > 50, f"{share:.0f} % of {len(wrong)} from 20 m on"))
    return judged
