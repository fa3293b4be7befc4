"""replay FRAMES PLANS PAGE: one page that plays a run: FRAMES are its frames, PLANS what `conelane drive --follow` answered. No
numpy and no matplotlib: the Python package of the library has this file too."""

import json
import math
import pkgutil
from collections import Counter
from html import escape

from .records import NUMBER, YES_OR_NO, InputError, read_json, read_lines, require, run

_EVERY = 2  # points of a path that are drawn, 0.5 m apart
_AHEAD_M = 20.0
_GAP_S = 0.5  # between frames
_SHORT_M = 3.0  # trusted
_CELL_M = 0.5  # cones of the whole run that are nearer than this are drawn once
_STATES = ("following", "finished", "searching", "bridging", "lost")  # from good to bad; from the third on the lane is not of the frame


def asset(name):
    return pkgutil.get_data(__package__, name).decode("utf-8")


def embedded(value):
    """JSON that may stand in a script element."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False).replace("</", "<\\/").replace("<!--", "<\\u0021--")


def shell(title, links, main, scripts=("frames.js", "viewer.js", "race.js")):
    """A whole page around its main part; nothing is loaded from elsewhere."""
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark"><title>conelane: {escape(title)}</title>
<link rel="icon" href="data:,"><style>{asset("style.css")}</style></head>
<body><header><div class="bar"><span class="name">conelane</span><nav aria-label="Sections">{links}</nav>
<button type="button" id="theme" aria-label="light or dark">◐</button></div></header>
<main>{main}</main>
<script type="application/json" id="marks">{asset("marks.json")}</script>
<script>{asset("tables.js")}</script>
<script type="module">{asset("drawing.mjs").replace("export ", "")}{"".join(map(asset, scripts))}</script>
</body></html>
"""


def player(race, note):
    """What race.js plays."""
    return ('<div class="stage"><canvas id="race-scene" role="img" aria-label="Race, seen from above"></canvas></div>'
            '<div class="transport"><button type="button" id="race-play" aria-label="play the race">▶</button>'
            '<input type="range" id="race-frame" min="0" value="0" aria-label="frame"><output id="race-time"></output>'
            f'</div><p class="note">{note}</p><script type="application/json" id="race-data">{embedded(race)}</script>')


def frame_lines(path, interval_s):
    """(number, frame) as `conelane drive --follow` counts and reads them, those of ft-fsd in conelane's own form, all with `time_s`. A
    frame may be {"reset": true}. Raises InputError, naming file and number."""
    with open(path, encoding="utf-8", errors="replace") as stream:
        is_list = stream.read(4096).lstrip().startswith("[")
    time_s = None
    for number, line in enumerate(read_json(path, list), 1) if is_list else read_lines(path):
        if not isinstance(line, dict):
            raise InputError(f"{path}:{number}: no JSON object")
        if "reset" in line and require(path, number, line, "reset", YES_OR_NO):
            time_s = None
            yield number, {"reset": True}
            continue
        line.pop("reset", None)
        time_s = line.get("time_s", 0.0 if time_s is None else time_s + interval_s)
        require(path, number, {"time_s": time_s}, "time_s", NUMBER)
        if "car_position" in line:
            colors = ("unknown", "yellow", "blue", "orange", "orange")
            try:
                cones = [{"x": x, "y": y, "color": color} for color, places in zip(colors, line["slam_cones"]) for x, y in places]
                (x, y), (ahead, left) = line["car_position"], line["car_direction"]
                line = {"pose": {"x": x, "y": y, "yaw": math.atan2(left, ahead)}, "cones": cones}
            except (KeyError, TypeError, ValueError):
                wanted = "car_position and car_direction must be [x, y], and slam_cones five lists of [x, y]"
                raise InputError(f"{path}:{number}: {wanted}") from None
        yield number, {**line, "time_s": time_s}


def _flat(points):
    return [round(value, 2) for point in points for value in point]


def _why(plan, seen, pose, gap_s):
    """Why the lane of a plan is not of its frame or hardly trusted, or the car had none before it."""
    if gap_s <= 0.0:
        return "the frame is not later than the one before"
    answer, (x, y, yaw) = plan["answer"], pose
    ahead = sum(1 for cx, cy in seen if math.hypot(cx - x, cy - y) <= _AHEAD_M
                and (cx - x) * math.cos(yaw) + (cy - y) * math.sin(yaw) > 0.0)
    if gap_s > _GAP_S:
        return f"{gap_s:.1f} s without a frame"
    if ahead < 3:
        return f"fewer than 3 cones within {_AHEAD_M:g} m ahead"
    if plan["state"] == "following":
        return f"less than {_SHORT_M:g} m of the lane are trusted"
    if answer["status"] == "found":
        return "the lane that is found differs from the one before, and is not confirmed"
    reason = {"none": "no lane", "stopped": "no lane before the limit of " + (answer.get("stopped_by") or "the search"),
              "error": "error: " + answer.get("message", "")}[answer["status"]]
    return f"{reason} among {ahead} cones within {_AHEAD_M:g} m ahead" + (
        f" ({answer['message']})" if answer["status"] == "stopped" and answer.get("message") else "")


class Replay:
    """Takes a run frame by frame and makes its page."""

    def __init__(self):
        self._frames, self._cones, self._whys, self._way_m = [], {}, [], 0.0
        self.reset()

    def reset(self):
        """Another run begins."""
        self._latest_s = math.nan  # every comparison with it is false

    def add(self, time_s, pose, seen, plan):
        """pose: x, y, yaw. seen: places of cones. plan: a line of `conelane drive --follow`, its `points` as rows s, x, y, heading,
        curvature, width to the left and to the right."""
        last = self._frames[-1] if self._frames else None
        gap_s = time_s - self._latest_s
        self._latest_s = max(time_s, self._latest_s)  # of a number and nan: the number
        self._way_m += math.hypot(pose[0] - last["x"], pose[1] - last["y"]) if last else 0.0
        rows = plan["points"][::_EVERY]
        sides = [[(x - side * row[column] * math.sin(row[3]), y + side * row[column] * math.cos(row[3]))
                  for row in rows for x, y in [row[1:3]]] for side, column in ((1, 5), (-1, 6))]
        for place in seen:
            self._cones[round(place[0] / _CELL_M), round(place[1] / _CELL_M)] = place
        state = plan["state"]
        is_flagged = state in _STATES[2:] or gap_s > _GAP_S or (state == "following" and plan["safe_m"] < _SHORT_M)
        why = "; ".join(dict.fromkeys(filter(None, [plan.get("reason"), is_flagged and _why(plan, seen, pose, gap_s)])))  # each once
        self._whys.append(why if is_flagged else "")
        self._frames.append({
            "t": round(time_s, 3), "x": round(pose[0], 2), "y": round(pose[1], 2), "yaw": round(pose[2], 4), "state": state,
            "seen": _flat(seen), "path": _flat(row[1:3] for row in rows), "left": _flat(sides[0]), "right": _flat(sides[1]),
            "safe": round(plan["safe_m"], 1), "trusted": sum(1 for row in rows if row[0] <= plan["safe_m"]),
            "says": ", ".join(filter(None, [
                f"lap {plan['lap']}", plan.get("phase", ""), f"trusted {plan['safe_m']:.1f} m",
                f"sure {100 * plan['answer']['confidence']:.1f} %" if plan["answer"].get("confidence") is not None else "",
                f"lane {plan['age_s']:.1f} s old" if plan["age_s"] > 0.0 else "", "stop" if plan["stop"] else "", why]))})

    def _episodes(self):
        """(first, last) of the frames in a row whose lane is not of the frame."""
        begin = None
        for i, why in enumerate([*self._whys, ""]):
            if why and begin is None:
                begin = i
            elif not why and begin is not None:
                yield begin, i - 1
                begin = None

    def _row(self, first, last):
        frames = self._frames[first:last + 1]
        state = max((frame["state"] for frame in frames), key=_STATES.index)
        why = Counter(self._whys[first:last + 1]).most_common(1)[0][0]
        return (f'<tr><th scope="row"><button class="link" data-frame="{first}">{frames[0]["t"]:.1f} s</button></th><td>{state}</td>'
                f'<td class="number">{last - first + 1}</td><td>{escape(why)}</td></tr>')

    def page(self, name):
        """The page as text."""
        counts = Counter(frame["state"] for frame in self._frames)
        shares = ", ".join(f"{state} {100 * count / len(self._frames):.1f} %" for state, count in counts.most_common())
        seconds = self._frames[-1]["t"] - self._frames[0]["t"]
        rows = "".join(self._row(*episode) for episode in self._episodes())
        table = ('<div class="table"><div class="scroll"><table><thead><tr><th scope="col">from</th><th scope="col">state</th>'
                 f'<th scope="col" class="number">frames</th><th scope="col">why</th></tr></thead><tbody>{rows}</tbody></table></div></div>')
        note = ("Dots: cones of the whole run. ○ cone of this frame. ━ left and right boundary, thin where they are not trusted. The line ahead of "
                "the car is its path. The strip shows the trusted length of each frame, up to 20 m, by state; click it to go there.")
        empty = [[] for _ in range(3)]
        race = dict(zip(("left", "right", "false_positives"), empty), other=_flat(self._cones.values()), frames=self._frames)
        body = (f'<h1>{escape(name)}</h1><p class="lead">{len(self._frames)} frames, {seconds:.1f} s, {self._way_m:.0f} m: {shares}.</p>'
                f'<section><canvas id="race-states" role="img" aria-label="States and trusted lengths"></canvas>{player(race, note)}</section>'
                f'<section><h2>Where there was no lane of the frame, or hardly a trusted one</h2>{table if rows else "<p>Nowhere.</p>"}</section>')
        return shell(f"replay of {name}", "", body, ("frames.js", "race.js"))


def main(arguments):
    frames_file, plans_file, page, interval_s = arguments
    replay = Replay()
    columns = ("s_m", "x_m", "y_m", "heading_rad", "curvature_1pm", "width_left_m", "width_right_m")
    plans = read_lines(plans_file)
    for _, frame in frame_lines(frames_file, float(interval_s)):
        if "reset" in frame:
            replay.reset()
            continue
        _, plan = next(plans)
        pose = frame["pose"]
        plan["points"] = [[point[key] for key in columns] for point in plan["points"]]
        replay.add(plan["time_s"], (pose["x"], pose["y"], pose["yaw"]), [(cone["x"], cone["y"]) for cone in frame["cones"]], plan)
    with open(page, "w", encoding="utf-8") as stream:
        stream.write(replay.page(frames_file.rpartition("/")[2]))


if __name__ == "__main__":
    run(main)
