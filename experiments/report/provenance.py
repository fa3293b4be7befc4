"""How the numbers came about."""

from html import escape

from .methods import whole
from .records import label_of
from .measures import RESAMPLES


def _word(value):
    """An entry of a list; a method with its cone-set size as in the tables."""
    if isinstance(value, dict) and "name" in value:
        return label_of(value["name"], value.get("nearest"))
    return str(value)


def _flat(value, prefix=""):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _flat(inner, f"{prefix}{key}.")
    elif isinstance(value, list):
        yield prefix[:-1], ", ".join(_word(inner) for inner in value)
    else:
        yield prefix[:-1], str(value)


def _conditions(results, conditions):
    """What the conditions of this run are."""
    pieces = [f"<b>{escape(condition['name'])}</b>: {whole(conditions, condition['name'])}" for condition in conditions
              if condition["name"] in results.conditions]
    return f"<li>Conditions. {'. '.join(pieces)}.</li>" if pieces else ""


def listed(entries):
    rows = "".join(f"<div><dt>{escape(key)}</dt><dd>{escape(value)}</dd></div>" for key, value in _flat(entries))
    return f'<dl class="run">{rows}</dl>'


def html(results, data, conditions):
    kept = ("" if not results.run.get("candidates") else
            "<li>This run kept all enumerated lanes to score them. This takes time, which is part of the latencies of enumerating "
            "methods.</li>")
    parameters = next((method["rld_parameters"] for method in results.run.get("methods", ())
                       if isinstance(method, dict) and "rld_parameters" in method), {})
    left_out = sum(len(track.get("left_out", ())) for track in results.tracks.values())
    degenerate = (f"<li>{left_out} scene{'s are' if left_out > 1 else ' is'} left out everywhere: the ground truth is degenerate, "
                  "it covers less than half of the area that its length and width ask for.</li>\n" if left_out else "")
    if data.missing:
        shown = "There are no scenes on this page."
    else:
        which = ("every scored scene" if len(data.frames) == data.scene_count else
                 f"{len(data.frames)} of {data.scene_count} scored scenes")
        shown = (f"The viewer holds {which}; positions are rounded to 1 cm. Tables and figures use all "
                 f"{data.scene_count}.")
    return f"""
<p>A car drives the centre line of each track. A scene is what it sees from one pose: the points within range in the
half-plane ahead, and false positives drawn uniformly among them until they make up the stated share of all points. A
scene of a run of a real car is a frame of its map; without annotated boundaries, the truth is the path that it drove.
Every method answers the same scenes, in order, and the same code scores the answers.</p>
<ul>
<li><b>Usable</b>: a lane was found, does not diverge from the annotated boundary within 20 m and, where it does not
diverge at all, is at least 20 m or 75 % of the ground truth long. <b>Success</b>: a lane was found and does not diverge
within 20 m, as the CLC paper counts. <b>Exact</b>: exactly the cones of the ground truth, in order.
<b>IoU</b>: area common to lane and ground truth over the area of both; 0 without a lane.
<b>Accurate</b>: at most one cone differs from the ground truth of the method's own cone set, each boundary lies on its
side of the car, no edges cross, the width is 2.5 m to 6.5 m.</li>
<li>A method marked n=12 saw only the 12 nearest cones ahead. Success and IoU still refer to all that is visible.</li>
<li>Intervals are percentile bootstraps over whole tracks ({RESAMPLES} resamples, 95 %), because scenes of one track
are similar; with few tracks they are rough. With one track there are none.</li>
{_conditions(results, conditions)}{kept}
<li>The papers' own numbers were measured on other machines and other data; they are shown for orientation only.</li>
{degenerate}<li>{escape(shown)} In the drawings, a cone on no annotated boundary counts as a false positive.</li>
</ul>
<h3>Run</h3>{listed(results.run)}
<h3>Parameters of RLD</h3>{listed(parameters) if parameters else "<p>No method of this run has them.</p>"}"""
