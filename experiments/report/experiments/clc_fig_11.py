"""CLC Fig. 11: iterations to the first good candidate

Claim: A candidate of IoU ≥ 98 % is enumerated early, in nearly every scene.
Protocol: share of scenes, rates up to 30 %, in which such a candidate was enumerated by then. A plateau below 100 % \
is what the search does not find within its limit.
Source: CLC paper, VIII-E, Fig. 11.
Published: most within 500 iterations; 5 % of scenes without one after 2500; a plateau up to 20000.
Command: conelane compare --methods clc --candidates --out RESULTS
"""

import numpy as np

from ..clc_rows import moderate
from ..experiment import Missing
from ..figures import drawn, variants
from ..theme import legend, method_style, new_figure


def html(results, published):
    samples = [moderate(sample) for sample in results.samples]
    samples = [sample for sample in samples if sample.has("first_near_iteration")]
    if not samples:
        raise Missing("no method kept its candidates.")
    figure, axes = new_figure()
    for sample, variant in variants(samples):
        iterations = np.sort(sample.known("first_near_iteration").first_near_iteration)
        shares = 100 * np.arange(1, len(iterations) + 1) / len(sample)
        places = np.unique(np.linspace(0, len(iterations) - 1, 200).astype(int))
        style = method_style(results.methods, sample.method, variant) | {"marker": ""}
        end = max(iterations[-1], np.nanmax(sample.iterations))  # the curve stays level to the limit
        axes.step([*iterations[places], end], [*shares[places], shares[-1]], where="post", label=sample.label, **style)
    axes.set_xlabel("iterations")
    axes.set_ylabel("scenes with one [%]")
    axes.set_ylim(0, 102)
    axes.set_xlim(left=0)
    legend(axes)
    return drawn("clc-fig-11", "Rates up to 30 %.", figure)
