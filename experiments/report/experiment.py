"""An experiment on the page. Each is a module of `experiments` whose docstring says what it is about:

    Title

    Claim: what is to be shown; of an experiment of a paper, what the paper claims.
    Protocol: how it is measured.
    Source: the paper and its figure, or this project.
    Published: what the paper prints, for those that reproduce one.
    Command: what makes the results that it is drawn from.

and whose `html(results, published)` gives its tables and figures, or raises Missing. An experiment of a paper also has
`verdict(results, published)`: (method, whether the claim holds of it here, the figures it is judged by) of each method
that the claim is about."""

import re
from html import escape


class Missing(Exception):
    """The results do not hold what the experiment shows; says what."""


def _described(module):
    """The title, and the parts of the docstring by their names."""
    title, _, rest = module.__doc__.strip().partition("\n")
    parts = re.findall(r"^(\w+): (.*?)(?=^\w+: |\Z)", rest.strip(), flags=re.M | re.S)
    return title, {name: " ".join(text.split()) for name, text in parts}


def _prose(text):
    """Text with `code`."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(text))


def _verdict(judged):
    """Whether a paper's claim holds here, for whom and by which figures."""
    if not judged:
        return '<p class="judged"><b>Not judged here</b>: no method of the paper took part.</p>'
    pieces = []
    for holds, words in ((True, "Holds here"), (False, "Does not hold here")):
        names = "; ".join(f"{escape(label)} ({escape(figures)})" for label, is_so, figures in judged if is_so == holds)
        if names:
            pieces.append(f'<b data-holds="{"yes" if holds else "no"}">{words}</b> for {names}.')
    return f'<p class="judged">{" ".join(pieces)}</p>'


def _block(module, content, verdict=""):
    title, parts = _described(module)
    details = "".join(f"<div><dt>{name}</dt><dd>{_prose(text)}</dd></div>" for name, text in parts.items()
                      if name != "Claim")
    claim = ("The paper claims: " if hasattr(module, "verdict") else "") + _prose(parts["Claim"])
    wide = " wide" if 'class="table"' in content or 'class="figures"' in content else ""
    return (f'<article class="experiment{wide}"><h3>{escape(title)}</h3><p class="claim">{claim}</p>'
            f'{verdict}{content}<details><summary>Protocol and source</summary><dl class="about">{details}</dl></details>'
            "</article>")


def blocks(modules, results, published, absent, advance=lambda: None):
    """The experiments in order. What the results do not hold is added to `absent`, with the command that makes it. `advance` is called before each."""
    present = []
    for module in modules:
        advance()
        try:
            content = module.html(results, published)
            judged = _verdict(module.verdict(results, published)) if hasattr(module, "verdict") else ""
            present.append(_block(module, content, judged))
        except Missing as missing:
            title, parts = _described(module)
            absent.append(f"<li><b>{escape(title)}</b>: {_prose(str(missing))} "
                          f"<code>{escape(parts['Command'])}</code></li>")
    return f'<div class="experiments">{"".join(present)}</div>' if present else ""
