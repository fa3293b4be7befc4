"""The page: sections in order, style and script inlined, nothing loaded from elsewhere."""

import json
import pkgutil
from html import escape

from . import experiments, filters, gallery, provenance, verdict
from .experiment import blocks
from .load import CATEGORIES
from .scenes import read_scenes
from .theme import METHOD_COLOURS

_VIEWER = """
<div id="viewer" tabindex="0" aria-label="Scene viewer">
<div class="controls">
<label>Track <select id="view-track"></select></label>
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
<div class="scroll"><table class="answers"><thead><tr><th scope="col">method</th><th scope="col">outcome</th>
<th scope="col" class="number">IoU %</th><th scope="col">accurate</th><th scope="col" class="number">latency ms</th>
</tr></thead><tbody id="view-methods"></tbody></table></div>
<p class="note">Arrow keys: pose and false positives. Space: play. Digits: methods on and off. Click the small map to go
there; point at a cone for its place. <span class="key band-key"></span> ground truth
<span class="key cone-key">●</span> cone <span class="key stray-key">×</span> false positive</p>
</div>"""


def _embedded(value):
    """JSON that may stand in a script element."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False).replace("</", "<\\/").replace("<!--", "<\\u0021--")


def _viewer(results, data):
    if data.missing:
        return f'<p class="left-out"><b>Viewer.</b> Left out: {escape(data.missing)}</p>'
    tracks = {track: {side: [round(100 * value) for point in boundaries[side] for value in point]
                      for side in ("left", "right")} | {"closed": bool(boundaries.get("closed", True))}
              for track, boundaries in results.tracks.items()}
    part = ("" if len(data.frames) == data.scene_count else
            f'<p class="note">One pose in {data.stride} of each lap, as the page has room for: {len(data.frames)} of '
            f"{data.scene_count} scenes. Tables and figures use all.</p>")
    methods = [{"label": sample.label, "colour": results.methods.index(sample.method) % METHOD_COLOURS}
               for sample in results.samples]
    content = {"methods": methods, "tracks": tracks, "laps": data.laps, "start": data.start, "frames": data.frames,
               "categories": [gallery.CATEGORY_WORDS[category] for category in CATEGORIES]}
    return f'{part}{_VIEWER}<script type="application/json" id="scene-data">{_embedded(content)}</script>'


def _asset(name):
    return pkgutil.get_data(__package__, name).decode("utf-8")


def render(results, published):
    """The whole page as text; the same results give the same bytes."""
    data = read_scenes(results)
    sections = (
        ("verdict", "Verdict", "Verdict", verdict.html(results)),
        ("comparison", "Comparison", "Comparison",
         filters.html(results) + blocks(experiments.COMPARISON, results, published)),
        ("exactness", "Exactness", "What exactness buys",
         blocks(experiments.EXACTNESS, results, published)),
        ("rld", "RLD paper", "Beside the RLD paper", blocks(experiments.RLD_PAPER, results, published)),
        ("clc", "CLC paper", "Beside the CLC paper", blocks(experiments.CLC_PAPER, results, published)),
        ("gallery", "Scenes", "Scenes", gallery.html(results, data)),
        ("play", "Viewer", "Scene viewer", _viewer(results, data)),
        ("protocol", "Protocol", "Protocol and provenance", provenance.html(results, data)))
    links = "".join(f'<a href="#{name}">{escape(short)}</a>' for name, short, _, _ in sections)
    body = "".join(f'<section id="{name}"><h2>{escape(title)}</h2>{content}</section>'
                   for name, _, title, content in sections)
    commit = escape(str(results.run.get("commit", "unknown")))
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark"><title>conelane: lanes between cones, compared</title>
<link rel="icon" href="data:,"><style>{_asset("style.css")}</style></head>
<body><header><div class="bar"><span class="name">conelane</span><nav aria-label="Sections">{links}</nav>
<button type="button" id="theme" aria-label="light or dark">◐</button></div></header>
<main><h1>Lanes between cones, compared</h1>
<p class="lead">Every method on the same scenes, scored by the same code, beside what the papers print.
Commit <code>{commit}</code>.</p>
{body}</main>
<script>{_asset("tables.js")}</script>
<script>{_asset("viewer.js")}</script>
</body></html>
"""
