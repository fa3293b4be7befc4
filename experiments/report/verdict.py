"""The verdict: which method, at which cone-set size and rate of false positives. Every sentence is computed."""

from html import escape

import numpy as np

from . import measures
from .experiments import optimality
from .figures import name_of_set, percent_label
from .leaders import MEASURES, REAL_TIME_BUDGET_MS, leaders_of, success_values
from .tables import Column, Cell, table, text

_IN_TIME_SHARE = 0.99  # of the scenes
_NBSP = "\u00a0"


def _grid(results):
    """(nearest, measure) -> [leaders by rate]; nearest "any" compares all methods."""
    sizes = list(dict.fromkeys(sample.nearest for sample in results.samples))
    grid = {}
    for nearest in sizes + (["any"] if len(sizes) > 1 else []):
        samples = [s for s in results.samples if nearest == "any" or s.nearest == nearest]
        for name, _, values_of in MEASURES:
            grid[nearest, name] = [leaders_of([s.at(rate) for s in samples], values_of) for rate in results.rates]
    return grid


def _joined(names):
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]


def _stretches(rates, leaders):
    """Runs of neighbouring rates with the same methods ahead: [(labels, first rate, last rate, means)]."""
    runs = []
    for rate, cell in zip(rates, leaders):
        if cell is None:
            continue
        labels = sorted(part.label for part in cell[1])
        if runs and runs[-1][0] == labels:
            runs[-1][2] = rate
            runs[-1][3].append(cell[0])
        else:
            runs.append([labels, rate, rate, [cell[0]]])
    return runs


def _span(values, digits=1):
    """First and last of what goes with neighbouring rates."""
    shown = [f"{100 * value:.{digits}f}{_NBSP}%" for value in values]
    return shown[0] if len(shown) == 1 else f"{shown[0]} to {shown[-1]}"


def _pieces(rates, leaders):
    """Who is ahead where, as text; "at every rate" where nothing changes."""
    runs = _stretches(rates, leaders)
    pieces = []
    for labels, first, last, means in runs:
        if len(runs) == 1 and len(means) == len(rates) > 1:
            where = "at every rate of false positives"
        elif first == last:
            where = f"at {percent_label(first)}{_NBSP}% false positives"
        else:
            where = f"from {percent_label(first)} to {percent_label(last)}{_NBSP}% false positives"
        names = _joined([f"<b>{escape(label)}</b>" for label in labels])
        level = "level, " if len(labels) > 1 else ""
        pieces.append(f"{names} {where} ({level}{_span(means)})")
    return ", ".join(pieces)


def _recommended(samples):
    """The one most often successful over all scenes, as a sentence's end; None without scores."""
    leaders = leaders_of(samples, success_values)
    if leaders is None:
        return None, ""
    best = leaders[1][0]
    level = [f"<b>{escape(sample.label)}</b>" for sample in leaders[1][1:]]
    tail = f" The tracks do not tell {_joined(level)} from it." if level else ""
    return best, (f"<b>{escape(best.label)}</b>: success in {100 * leaders[0]:.1f}{_NBSP}% of all scenes and rates, "
                  f"mean IoU {100 * best.iou.mean():.1f}{_NBSP}%, 99{_NBSP}% of the answers within "
                  f"{measures.quantile(best.latency, 0.99):.2f}{_NBSP}ms.{tail}")


def _headline(results):
    """The method to run among those that keep the real-time budget; where it carries its last lane along, which the
    scenes reward more than a track would, also the best of those that do not."""
    in_time = [sample for sample in results.samples
               if np.mean(sample.latency <= REAL_TIME_BUDGET_MS) >= _IN_TIME_SHARE]
    best, text_of_best = _recommended(in_time)
    if best is None:
        return ""
    headline = f'<p class="headline">Run {text_of_best}</p>'
    if not best.carries_state:
        return headline
    _, without = _recommended([sample for sample in in_time if not sample.carries_state])
    return headline + ("<p>It carries its last lane along, and these scenes draw false positives anew at every pose, "
                       "so it filters them out; where they stay in place it gains less."
                       f"{f' Without such memory, {without}' if without else ''}</p>")


def _sentence(results, nearest, grid):
    """The leaders on one cone set by both measures."""
    lead = "Of all methods" if nearest == "any" else f"On {name_of_set(nearest)}"
    samples = [sample for sample in results.samples if nearest in ("any", sample.nearest)]
    parts = []
    for name, words, _ in MEASURES:
        known = [cell for cell in grid[nearest, name] if cell]
        if not known:
            continue
        if len(samples) == 1:
            parts.append(f"{words} in {_span([mean for mean, _ in known])}")
        else:
            parts.append(f"most often {words}: {_pieces(results.rates, grid[nearest, name])}")
    if not parts:
        return ""
    if len(samples) == 1:
        rates = f"{percent_label(results.rates[0])} to {percent_label(results.rates[-1])}{_NBSP}%"
        return (f"<li>{lead}, <b>{escape(samples[0].label)}</b> alone: {', '.join(parts)} of the scenes, false "
                f"positives from {rates}.</li>")
    return f"<li>{lead}, {'; '.join(parts)}.</li>"


def _speed_sentence(results):
    medians = {sample.label: float(np.median(sample.latency)) for sample in results.samples}
    fastest = min(medians, key=medians.get)
    late = []
    for sample in results.samples:
        share = float(np.mean(sample.latency > REAL_TIME_BUDGET_MS))
        if share > 0:
            late.append(f"{escape(sample.label)} in {100 * share:.2g}{_NBSP}%")
    budget = (f"The 50 ms of a 20 Hz LiDAR are exceeded by {_joined(late)} of the scenes." if late else
              "No method exceeds the 50 ms of a 20 Hz LiDAR in any scene.")
    return (f"<li>Lowest median latency: <b>{escape(fastest)}</b>, {medians[fastest]:.2f} ms over all scenes. "
            f"{budget}</li>")


def _agreement_sentence(results):
    """Whether methods that proved optimality on the same cone sets state the same objective."""
    tolerance = 1e-6
    pieces = []
    for nearest in dict.fromkeys(s.nearest for s in results.samples):
        samples = [s for s in results.samples if s.nearest == nearest and s.has("objective")]
        proven = [{scene: value for scene, value, optimal in zip(s.scene, s.objective, s.optimal) if optimal == 1.0}
                  for s in samples]
        scenes = [scene for scene in dict.fromkeys(scene for values in proven for scene in values)
                  if sum(scene in values for values in proven) > 1]
        if not scenes:
            continue
        apart = sum(max(found) - min(found) > tolerance for found in
                    ([values[scene] for values in proven if scene in values] for scene in scenes))
        names = _joined([escape(s.label) for s in samples])
        pieces.append(f"<li>{names} state the same optimum within 10<sup>−6</sup> in {len(scenes) - apart} of "
                      f"{len(scenes)} scenes that more than one of them solved to proven optimality.</li>")
    return "".join(pieces)


def _checker_sentence(results):
    """What the independent checker said of what the RLD methods answered."""
    accepted = int(sum(np.nansum(sample.checked) for sample in results.samples))
    errors = int(sum(np.sum(sample.status == "error") for sample in results.samples))
    if not accepted:
        return ""
    failed = (f"accepted {accepted} lane graphs; {errors} answers were errors and count as failures" if errors else
              f"accepted all {accepted} lane graphs; no answer was an error")
    return f"<li>Of what the RLD methods answered, the independent checker {failed}.</li>"


def _optimality_sentence(results):
    """How far the graph search is from RLD's optimum, and which of the two drives better."""
    rows = optimality.compared(optimality.read(results))
    if not rows:
        return ""
    equal = np.mean([float(row["equal"]) for row in rows])
    best, candidate = (optimality.success(rows, name) for name in ("optimum", "candidate"))
    interval = measures.mean_interval(best - candidate, optimality.tracks_of(rows))
    told = interval and not interval[0] <= 0.0 <= interval[1]
    drives = ("drives no better or worse" if not told else
              "drives better" if best.mean() > candidate.mean() else "drives worse")
    return (f"<li>Under RLD's objective, the best of CLC's candidates is the proven optimum in "
            f"{100 * equal:.1f}{_NBSP}% of {len(rows)} scenes. The optimum {drives}: success "
            f"{100 * best.mean():.1f}{_NBSP}% against {100 * candidate.mean():.1f}{_NBSP}%.</li>")


def _tiles(results):
    scenes = len(set().union(*(set(sample.scene) for sample in results.samples)))
    tracks = len({track for sample in results.samples for track in sample.track})
    answers = sum(len(sample) for sample in results.samples)
    tiles = ((f"{scenes:,}".replace(",", "\u202f"), "scenes"), (str(tracks), "tracks"),
             (str(len(results.samples)), "methods"), (f"{answers:,}".replace(",", "\u202f"), "answers scored"))
    return '<dl class="tiles">' + "".join(f"<div><dd>{n}</dd><dt>{what}</dt></div>" for n, what in tiles) + "</dl>"


def _grid_table(results, grid):
    columns = [Column("cone set", "text"), Column("measure", "text")] + [
        Column(f"{percent_label(rate)} % false positives", "text") for rate in results.rates]
    rows = []
    titles = {name: words for name, words, _ in MEASURES}
    for (nearest, name), leaders in grid.items():
        where = "any" if nearest == "any" else "all visible" if nearest is None else f"nearest {nearest}"
        cells = []
        for cell in leaders:
            if cell is None:
                cells.append(Cell("–"))
            else:
                labels = ", ".join(sorted(part.label for part in cell[1]))
                cells.append(Cell(labels, labels, f"{100 * cell[0]:.1f} %"))
        rows.append([text(where), text(titles[name])] + cells)
    return table("winners", "Ahead, by cone set and false positives", columns, rows,
                 note="All ranges together. Several names: their paired difference to the best has a 95 % interval, "
                 "tracks resampled, that holds zero. The number is the best one's mean. Accurate refers to the "
                 "method's own cone set, so of all methods those on few cones have the easier task; success does not.")


def html(results):
    grid = _grid(results)
    sentences = "".join(_sentence(results, nearest, grid) for nearest in dict.fromkeys(key[0] for key in grid))
    return (_headline(results) + _tiles(results) + f'<ul class="verdict">{sentences}{_speed_sentence(results)}'
            f"{_agreement_sentence(results)}{_optimality_sentence(results)}{_checker_sentence(results)}</ul>" +
            _grid_table(results, grid))
