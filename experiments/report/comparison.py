"""The comparison's tables. Their numbers are those of results.jsonl; only the intervals come from the scores."""

from . import measures
from .comparison_figures import profile_figures, quality_figures
from .figures import group
from .load import CATEGORIES, label_of
from .tables import Cell, Column, method_cell, milliseconds, percent, table, text

_CATEGORY_TITLES = {"ground_truth": "ground truth %", "near_ground_truth": "near %", "too_short": "too short %",
                    "diverging_from_20": "diverging ≥ 20 m %", "diverging_below_20": "diverging < 20 m %",
                    "none": "none %"}


def _key_cells(results, row):
    label = label_of(row["method"], row.get("nearest"))
    return [method_cell(results.methods, row["method"], label), percent(row["false_positive_rate"]), Cell(f"{row['range']:g}", row["range"]),
            Cell(str(row["scenes"]), row["scenes"])]


_KEYS = [Column("method", "text"), Column("false positives %"), Column("range m"), Column("scenes")]


def _attributes(results):
    return [{"method": label_of(row["method"], row.get("nearest")), "rate": row["false_positive_rate"],
             "range": row["range"]} for row in results.rows]


def _part(results, row):
    label = label_of(row["method"], row.get("nearest"))
    sample = next(sample for sample in results.samples if sample.label == label)
    return sample.at(row["false_positive_rate"], row["range"])


def quality_table(results):
    rows = []
    for row in results.rows:
        part = _part(results, row)
        accurate = part.known("accurate")
        rows.append(_key_cells(results, row) + [
            percent(row["success_share"], interval=measures.mean_interval(part.success, part.track),
                    measure="success_share"),
            percent(row["mean_iou"], interval=measures.mean_interval(part.iou, part.track), measure="mean_iou"),
            percent(row.get("accurate_share"), interval=measures.mean_interval(accurate.accurate, accurate.track),
                    measure="accurate_share"),
            percent(row.get("solved_share"), measure="solved_share"),
            percent(row.get("complete_share"), measure="complete_share")])
    columns = _KEYS + [Column("success %"), Column("mean IoU %"), Column("accurate %"), Column("solved %"),
                       Column("complete %")]
    return table("quality", "Quality", columns, rows, row_attributes=_attributes(results),
                 note="Small: 95 % interval, tracks resampled. Solved: proven optimal within 0.4 s. Complete: the "
                 "enumeration came to its end.")


def latency_table(results):
    rows = []
    for row in results.rows:
        part = _part(results, row)
        latency = row["latency_ms"]
        interval = measures.median_interval(part.latency, part.track)
        rows.append(_key_cells(results, row) + [milliseconds(latency["median"], interval=interval, measure="median")] + [
            milliseconds(latency[key], measure=key)
            for key in ("mean", "shifted_geometric_mean", "p95", "p99", "max")] +
            [percent(row.get("within_budget_share"), measure="within_budget_share")])
    columns = _KEYS + [Column("median ms"), Column("mean ms"), Column("geometric mean ms"), Column("p95 ms"),
                       Column("p99 ms"), Column("max ms"), Column("within 50 ms %")]
    return table("latencies", "Latency", columns, rows, row_attributes=_attributes(results),
                 note="From the scene in memory to the lane in memory. Geometric mean: shifted by 1 ms. Small: 95 % "
                 "interval, tracks resampled.")


def category_table(results):
    rows = [_key_cells(results, row) + [percent(row["share"].get(key), measure=key) for key in CATEGORIES]
            for row in results.rows]
    columns = _KEYS + [Column(_CATEGORY_TITLES[key]) for key in CATEGORIES]
    return table("categories", "What became of the scenes", columns, rows, row_attributes=_attributes(results),
                 note="The first that fits of: none, ground truth, diverging, too short, near. All but none and "
                 "diverging < 20 m are successes.")


def ratio_table(results):
    """Latency against the fastest method of the same cone set, on the same scenes."""
    rows = []
    for nearest in dict.fromkeys(sample.nearest for sample in results.samples):
        samples = [sample for sample in results.samples if sample.nearest == nearest]
        if len(samples) < 2:
            continue
        fastest = min(samples, key=lambda sample: measures.shifted_geometric_mean(sample.latency))
        for sample in samples:
            if sample is fastest:
                continue
            ratio = measures.latency_ratio(sample, fastest)
            if ratio:
                mean, interval, count = ratio
                small = f"{interval[0]:.2f}–{interval[1]:.2f}" if interval else ""
                rows.append([method_cell(results.methods, sample.method, sample.label), text(fastest.label), Cell(f"{mean:.2f}", mean, small),
                             Cell(str(count), count)])
    if not rows:
        return '<p class="left-out"><b>Paired latencies.</b> Left out: no two methods saw the same cone sets.</p>'
    columns = [Column("method", "text"), Column("against the fastest", "text"), Column("time ratio"),
               Column("scenes of both")]
    return table("ratios", "Paired latencies", columns, rows,
                 note="Geometric mean of the ratio on the same scene, methods of the same cone set only; 2.00 is twice "
                 "the time. Small: 95 % interval, tracks resampled.")


def track_table(results):
    tracks = sorted({track for sample in results.samples for track in sample.track})
    rows = []
    for track in tracks:
        row = [text(track)]
        for sample in results.samples:
            part = sample.where(sample.track == track)
            row.append(percent(part.success.mean() if len(part) else None))
        rows.append(row)
    columns = [Column("track", "text")] + [Column(sample.label + " %") for sample in results.samples]
    return table("by-track", "Success by track", columns, rows, note="All rates and ranges together.")


def _filters(results):
    def choice(key, title, values, show):
        options = "".join(f'<option value="{value}">{show(value)}</option>' for value in values)
        return (f'<label>{title} <select data-filter="{key}"><option value="">all</option>{options}</select></label>')

    rates = choice("rate", "False positives", results.rates, lambda rate: f"{100 * rate:.1f} %")
    ranges = choice("range", "Range", results.ranges, lambda value: f"{value:g} m")
    methods = choice("method", "Method", [sample.label for sample in results.samples], str)
    return f'<div class="controls" id="filters">{methods}{rates}{ranges}</div>'


def html(results):
    return (_filters(results) + quality_table(results) + latency_table(results) + group(quality_figures(results)) +
            ratio_table(results) + group(profile_figures(results)) + category_table(results) + track_table(results))
