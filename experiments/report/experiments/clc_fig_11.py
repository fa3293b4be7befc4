"""CLC Fig. 11: iterations to the first good candidate

Claim: A candidate of IoU ≥ 98 % is enumerated early, in nearly every scene.
Protocol: share of scenes, rates up to 30 %, in which such a candidate was enumerated up to this iteration. A \
plateau below 100 %: in the other scenes, none is found within the limit.
Source: CLC paper, VIII-E, Fig. 11.
Published: most within 500 iterations; 5 % of scenes without one after 2500; a plateau up to 20000.
Command: conelane compare --methods clc --candidates --out RESULTS/candidates
"""

import numpy as np

from ..clc_rows import moderate, of_paper
from ..experiment import Missing
from ..figures import drawn, variants
from ..theme import legend, method_style, new_figure


_EARLY, _NEARLY_EVERY = 500, 95.0  # iterations; per cent of the scenes, after the paper's figures


def _stored(results):
    for stored in (results.beside["candidates"], results.samples):
        samples = [sample for sample in map(moderate, stored) if sample.has("first_near_iteration")]
        if samples:
            return samples
    return []


def html(results, published):
    samples = _stored(results)
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
    return drawn("clc-fig-11", "A curve that rises early: good lanes are found early. Where it is level, no more are found.", figure)


def verdict(results, published):
    """Most scenes have one early, nearly every one has one in the end."""
    judged = []
    for sample in of_paper(_stored(results)):
        first = sample.known("first_near_iteration").first_near_iteration
        early, ever = (100 * np.count_nonzero(first <= most) / len(sample) for most in (_EARLY, np.inf))
        judged.append((sample.label, early > 50 and ever >= _NEARLY_EVERY,
                       f"{early:.1f} % within {_EARLY} iterations, {ever:.1f} % in the end"))
    return judged
