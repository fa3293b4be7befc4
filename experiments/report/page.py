"""The page: sections in order, style and script inlined, nothing loaded from elsewhere."""

from html import escape

from . import experiments, gallery, headline, provenance
from .experiment import blocks
from .experiments.solvers import first_figure
from .load import CATEGORIES
from .methods import whole
from .replay import embedded, shell
from .scenes import read_scenes
from .summaries import percent_label
from .theme import METHOD_COLORS

_VIEWER = """
<div id="viewer" tabindex="0" aria-label="Scene viewer">
<div class="controls">
<label>Track <select id="view-track"></select></label>
<label>Condition <select id="view-condition"></select></label>
<label>False positives <select id="view-rate"></select></label>
<label>Range <select id="view-range"></select></label>
<label>Speed <select id="view-speed"><option value="4">4 / s</option><option value="10" selected>10 / s</option>
<option value="25">25 / s</option></select></label>
</div>
<div class="stage"><canvas id="view-scene" role="img" aria-label="Scene"></canvas>
<canvas id="view-map" role="img" aria-label="Track, click to go there"></canvas><div id="view-tip" hidden></div></div>
<div class="transport">
<button type="button" id="view-back" aria-label="previous pose">‹</button>
<button type="button" id="view-play" aria-label="play the lap">▶</button>
<button type="button" id="view-next" aria-label="next pose">›</button>
<input type="range" id="view-pose" min="0" value="0" aria-label="pose"><output id="view-name"></output></div>
<div class="scroll"><table class="answers"><thead><tr><th scope="col">method</th><th scope="col">usable</th><th scope="col">outcome</th>
<th scope="col" class="number">IoU %</th><th scope="col">accurate</th><th scope="col" class="number">latency ms</th>
<th scope="col" class="number">sure %</th><th scope="col" class="number">trusted m</th>
</tr></thead><tbody id="view-methods"></tbody></table></div>
<p class="note">Arrow keys: pose and false positives. Space: play. Digits: methods on and off. Click the small map to go
there; point at a cone for its place. <span class="key"><span class="band-key"></span> ground truth</span>
<span class="key"><b class="left-key">━</b> left and <b class="right-key">━</b> right boundary where one method is on</span>
<span class="key">┅ gap that a lane bridges</span> <span class="key">┈ boundary inferred from the other one</span>
<span class="key">— across a lane: trusted up to here</span>
<span class="key">● cone</span> <span class="key">○ cone that was missed</span> <span class="key">× false positive</span>
<span class="key"><span class="driven-key">┅</span> path that was driven</span></p>
</div>"""


def _flat(points):
    return [round(100 * value) for point in points for value in point]


def _part_shown(data):
    """Which laps the viewer has, where it has not all."""
    if len(data.frames) == data.scene_count:
        return ""
    if data.stride > 1:
        which = f"one pose in {data.stride} of the chosen tracks' {data.whole_laps} laps"
    else:
        which = (f"{data.whole_laps} of {data.lap_count} laps whole, those first on which the methods fail most, at "
                 "the gallery's rate and the shortest range before others")
    return (f'<p class="note">As the page has room for, {which}, and the gallery\'s scenes: {len(data.frames)} of '
            f"{data.scene_count} scenes. <code>conelane report --viewer TRACK,…</code> makes a page with the laps of "
            "other tracks. Tables and figures use all scenes.</p>")


def _viewer(results, data):
    if data.missing:
        return f'<p class="left-out"><b>Viewer.</b> Left out: {escape(data.missing)}</p>'
    shown = {lap["track"] for lap in data.laps}
    tracks = {track: {side: _flat(boundaries.get(side, [])) for side in ("left", "right", "driven")} |
              {"closed": bool(boundaries.get("closed", True))}
              for track, boundaries in results.tracks.items() if track in shown}
    methods = [{"label": sample.label, "color": results.methods.index(sample.method) % METHOD_COLORS}
               for sample in results.samples]
    content = {"methods": methods, "longest_gap": 100 * data.longest_gap_m,
               "usual_width": 100 * data.usual_width_m, "tracks": tracks, "laps": data.laps, "start": data.start,
               "frames": data.frames,
               "categories": [gallery.CATEGORY_WORDS[category] for category in CATEGORIES],
               "causes": gallery.CAUSE_WORDS}
    return (f'{_part_shown(data)}{_VIEWER}<script type="application/json" id="scene-data">{embedded(content)}'
            "</script>")


def _one_condition(results):
    """Which of several conditions the figures of a section take."""
    if len(results.conditions) < 2:
        return ""
    return (f'<p class="note">This section uses condition {escape(results.main_condition)} only, as the papers '
            "do.</p>")


def _explained(results, conditions):
    """What the conditions are, beside the choice of one."""
    told = [f"<b>{escape(name)}</b>: {escape(whole(conditions, name))}." for name in results.conditions
            if whole(conditions, name)]
    return f'<p class="note conditions">{" ".join(told)}</p>' if told else ""


def _filters(results, conditions):
    """The choices above the comparison. They hide rows of the tables, curves of the charts, and charts and pictures of other conditions."""
    def choice(key, title, values, show):
        if len(values) < 2:
            return ""
        options = "".join(f'<option value="{escape(str(value))}">{escape(show(value))}</option>' for value in values)
        return f'<label>{title} <select data-filter="{key}"><option value="">all</option>{options}</select></label>'

    everywhere = [choice("condition", "Condition", results.conditions, lambda name: name or "none named"),
                  choice("method", "Method", [sample.label for sample in results.samples], str)]
    in_tables = [choice("rate", "False positives", results.rates, lambda rate: f"{percent_label(rate)} %"),
                 choice("range", "Range", results.ranges, lambda value: f"{value:g} m")]
    groups = [("Show in tables, charts and pictures", everywhere), ("in tables", in_tables)]
    return '<div class="controls" id="filters">' + "".join(
        f"<span>{words}:</span>{''.join(choices)}" for words, choices in groups if any(choices)) + "</div>" + _explained(results, conditions)


def _sections(results, published, data):
    """(id, short title, title, content) of each; those of which the results hold nothing are left out. Without a comparison there are
    studies of solvers alone."""
    absent, conditions = [], published["conditions"]

    def shown(modules, of=results):
        return blocks(modules, of, published, absent)

    def alone(modules):
        content = shown(modules, main)
        return note + content if content else ""

    def exactness():
        return ("exactness", "Exactness", "The benefit of exact solvers", headline.exactness(results) + shown(experiments.EXACTNESS))
    if data:
        main, note = results.under(results.main_condition), _one_condition(results)
        sections = [
            ("verdict", "Headline", "The methods, best first", headline.html(results, data, conditions)),
            ("comparison", "Comparison", "Comparison", _filters(results, conditions) + shown(experiments.COMPARISON)
             + headline.by_rate(results, conditions)),
            ("race", "Race", "Races driven with the answers", shown(experiments.RACE)),
            ("failures", "Failures", "Where lanes go wrong", shown(experiments.FAILURES) + gallery.html(results, data)),
            ("play", "Viewer", "Scene viewer", _viewer(results, data)),
            ("speed", "Speed", "Speed on the same cones", alone(experiments.SPEED)), exactness(),
            ("rld", "RLD paper", "Compared with the RLD paper", alone(experiments.RLD_PAPER)),
            ("clc", "CLC paper", "Compared with the CLC paper", alone(experiments.CLC_PAPER))]
        run = provenance.html(results, data, conditions)
    else:
        sections, run = [exactness()], f"<h3>Run</h3>{provenance.listed(results.run)}"
    missing = f'<div class="absent"><h3>Not in these results</h3><ul>{"".join(absent)}</ul></div>' if absent else ""
    return [section for section in [*sections, ("protocol", "Protocol", "Protocol and provenance", run + missing)] if section[3]]


def _intro(results, data):
    commit = f"Commit <code>{escape(str(results.run.get('commit', 'unknown')))}</code>."
    if not data:
        return ('<div><h1>Solvers of cone lanes, compared</h1><p class="lead">Studies of solvers, without a comparison of methods. '
                f"{commit}</p></div>")
    return (f'<div><h1>Lanes between cones, compared</h1>\n<p class="lead">{_lead(results)} {commit}</p>'
            f"{headline.answer(results)}</div>{headline.picture(results, data)}")


def _lead(results):
    """What kind of comparison this is."""
    held_out = results.run.get("cross_validation")
    families = held_out.get("families", {}) if isinstance(held_out, dict) else {}
    how = (f" Held out: methods that learn were trained again for each of {len(families)} families of courses, without this family."
           if families else "")
    scenes = len(set().union(*(set(sample.scene) for sample in results.samples)))
    tracks = len(set().union(*(set(sample.track) for sample in results.samples)))
    return ("A Formula Student course is marked by cones alone. A <b>cone lane</b> is the chain of cones on the car's "
            '<b class="left-key">left</b> and the one on its <b class="right-key">right</b> between which the course goes on. '
            '</p><p class="lead">Compared: '
            f"{len(results.samples)} methods on the same {scenes} scenes of {tracks} track{'s' if tracks > 1 else ''}, scored by "
            f"the same code; the figures of the papers are shown beside them.{how}")


def render(results, published, tracks=()):
    """The whole page as text; the same results give the same bytes. `tracks`: see read_scenes."""
    data = read_scenes(results, published["conditions"], tracks, published["longest_gap_m"],
                       published["usual_width_m"]) if results.samples else None
    sections = _sections(results, published, data)
    links = "".join(f'<a href="#{name}">{escape(short)}</a>' for name, short, _, _ in sections)
    body = [f'<section id="{name}"><h2>{escape(title)}</h2>{content}</section>' for name, _, title, content in sections]
    # Below the headline, whose whole table is to be on the first screen. A page of studies alone begins with the figure.
    body.insert(1 if data else 0, first_figure(results))
    return shell("lanes between cones, compared", links, f'<div class="intro">{_intro(results, data)}</div>\n{"".join(body)}')
