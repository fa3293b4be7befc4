"""The verdict: which method, at which cone-set size and rate of false positives. Every sentence is computed."""

from html import escape

import numpy as np

from . import measures
from .figures import percent_label
from .tables import Column, Cell, table, text

REAL_TIME_BUDGET_MS = 50.0


def accurate_values(part):
    part = part.known("accurate")
    return dict(zip(part.scene, part.accurate)), dict(zip(part.scene, part.track))


def success_values(part):
    return dict(zip(part.scene, part.success)), dict(zip(part.scene, part.track))


def difference_interval(first, second, values_of):
    """Interval of the mean of first - second over the scenes that both have; None for a single track."""
    (a, tracks), (b, _) = values_of(first), values_of(second)
    scenes = [scene for scene in a if scene in b]
    if not scenes:
        return None
    differences = np.array([a[scene] - b[scene] for scene in scenes])
    return measures.mean_interval(differences, np.array([tracks[scene] for scene in scenes], dtype=object))


MEASURES = (("accurate", "accurate lanes", accurate_values), ("success", "success", success_values))


def _leaders(parts, values_of):
    """(mean, samples): the highest mean, and all that the tracks do not tell from it. None without values."""
    means = [(float(np.mean(list(values_of(part)[0].values()))), part) for part in parts if values_of(part)[0]]
    if not means:
        return None
    best_mean, best = max(means, key=lambda pair: pair[0])
    level = [best]
    for mean, part in means:
        if part is best:
            continue
        interval = difference_interval(best, part, values_of)
        if mean == best_mean or (interval and interval[0] <= 0.0 <= interval[1]):
            level.append(part)
    return best_mean, level


def _name_of_set(nearest):
    return "all that is visible" if nearest is None else f"the {nearest} nearest cones"


def _grid(results):
    """(nearest, measure) -> [leaders by rate]; nearest "any" compares all methods."""
    sizes = list(dict.fromkeys(sample.nearest for sample in results.samples))
    grid = {}
    for nearest in sizes + (["any"] if len(sizes) > 1 else []):
        samples = [s for s in results.samples if nearest == "any" or s.nearest == nearest]
        for name, _, values_of in MEASURES:
            grid[nearest, name] = [_leaders([s.at(rate) for s in samples], values_of) for rate in results.rates]
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


def _sentence(results, nearest, title, leaders):
    runs = _stretches(results.rates, leaders)
    if not runs:
        return ""
    alone = nearest != "any" and sum(sample.nearest == nearest for sample in results.samples) == 1
    pieces = []
    for labels, first, last, means in runs:
        where = (f"at {percent_label(first)} %" if first == last else
                 f"from {percent_label(first)} to {percent_label(last)} %")
        numbers = f"{100 * means[0]:.1f} %" if len(means) == 1 else f"{100 * means[0]:.1f} to {100 * means[-1]:.1f} %"
        level = ", level within what the tracks can tell" if len(labels) > 1 else ""
        names = _joined([f"<b>{escape(label)}</b>" for label in labels])
        pieces.append(f"{names} {where} false positives ({numbers}{level})")
    lead = "Of all methods" if nearest == "any" else f"On {_name_of_set(nearest)}"
    return f"<li>{lead}, {f'{title}, a single method' if alone else f'most {title}'}: {'; '.join(pieces)}.</li>"


def _speed_sentence(results):
    medians = {sample.label: float(np.median(sample.latency)) for sample in results.samples}
    fastest = min(medians, key=medians.get)
    late = []
    for sample in results.samples:
        share = float(np.mean(sample.latency > REAL_TIME_BUDGET_MS))
        if share > 0:
            late.append(f"{escape(sample.label)} in {100 * share:.2g} %")
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
    titles = {name: title for name, title, _ in MEASURES}
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
                 "tracks resampled, that holds zero. The number is the best one's mean.")


def html(results):
    grid = _grid(results)
    sentences = "".join(_sentence(results, nearest, dict((n, t) for n, t, _ in MEASURES)[name], leaders)
                        for (nearest, name), leaders in grid.items())
    return (_tiles(results) + f'<ul class="verdict">{sentences}{_speed_sentence(results)}'
            f"{_agreement_sentence(results)}</ul>" + _grid_table(results, grid))
