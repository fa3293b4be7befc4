"""An experiment on the page. It is a function (results, published) that gives its tables and figures or raises Missing, and
its docstring says what it is about, a part after the other:

    Title
    Claim: what is to be shown; of an experiment of a paper, what the paper claims.
    Protocol: how it is measured.
    Source: the paper and its figure, or this project.
    Published: what the paper prints, for those that reproduce one.
    Command: what makes the results that it is drawn from.

An experiment of a paper is also judged: whether the claim holds here."""

import re
from html import escape

from .load import Missing

_PARTS = "Claim|Protocol|Source|Published|Command"


class Experiment:
    def __init__(self, show):
        self.show, self.verdict = show, None
        self.title, _, rest = show.__doc__.strip().partition("\n")
        parts = re.findall(rf"^ *({_PARTS}): (.*?)(?=^ *(?:{_PARTS}): |\Z)", rest.strip(), flags=re.M | re.S)
        self.parts = {name: " ".join(text.split()) for name, text in parts}

    def judged(self, subjects):
        """A decorator of what is said of one of the pairs (label, subject) that `subjects` finds in (results, published): whether the claim
        holds of the subject, and the figures it is judged by; None where there is nothing to judge by."""
        def keep(judge):
            def verdict(results, published):
                found = [(label, judge(subject, published)) for label, subject in subjects(results, published)]
                return [(label, *said) for label, said in found if said]
            self.verdict = verdict
            return judge
        return keep

    def html(self, results, published):
        content = self.show(results, published)
        details = "".join(f"<div><dt>{name}</dt><dd>{_prose(text)}</dd></div>" for name, text in self.parts.items()
                          if name != "Claim")
        claim = ("The paper claims: " if self.verdict else "") + _prose(self.parts["Claim"])
        judged = _judged(self.verdict(results, published)) if self.verdict else ""
        wide = " wide" if 'class="table"' in content or 'class="figures"' in content else ""
        return (f'<article class="experiment{wide}"><h3>{escape(self.title)}</h3><p class="claim">{claim}</p>'
                f'{judged}{content}<details><summary>Protocol and source</summary><dl class="about">{details}</dl></details>'
                "</article>")


def _prose(text):
    """Text with `code`."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(text))


def _judged(verdict):
    """Whether a paper's claim holds here, for whom and by which figures."""
    if not verdict:
        return '<p class="judged"><b>Not judged here</b>: no method of the paper took part.</p>'
    pieces = []
    for holds, words in ((True, "Holds here"), (False, "Does not hold here")):
        names = "; ".join(f"{escape(label)} ({escape(figures)})" for label, is_so, figures in verdict if is_so == holds)
        if names:
            pieces.append(f'<b data-holds="{"yes" if holds else "no"}">{words}</b> for {names}.')
    return f'<p class="judged">{" ".join(pieces)}</p>'


def blocks(experiments, results, published, absent):
    """The experiments in order. What the results do not hold is added to `absent`, with the command that makes it."""
    present = []
    for experiment in experiments:
        try:
            present.append(experiment.html(results, published))
        except Missing as missing:
            absent.append(f"<li><b>{escape(experiment.title)}</b>: {_prose(str(missing))} "
                          f"<code>{escape(experiment.parts['Command'])}</code></li>")
    return f'<div class="experiments">{"".join(present)}</div>' if present else ""
