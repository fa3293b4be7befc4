"""docs/learned-costs.svg: usable lanes, IoU and scenes with the highest score against the width of the beam."""

import html
import io
import json
import re

# By key of a row: label, colour, dashes.
CURVES = {"best_score": ("scenes with the highest score found", "muted", "--"), "first_usable": ("usable lanes, by score", "m3", "-"),
          "iou": ("IoU", "m6", ":")}


def points(stored):
    """(beam, share in per cent) by curve; nothing without figures. The picture holds them, too: a check need not draw it."""
    rows = [row for row in stored.get("rows", []) if row["table"] == "beam"]
    return {key: [[row["beam"], round(100 * row[key], 4)] for row in rows] for key in CURVES} if rows else {}


def points_in(svg):
    return json.loads(html.unescape(re.search(r"<dc:description>(.*?)</dc:description>", svg, flags=re.S)[1]))


def picture(stored):
    from report.theme import SURFACE, legend, new_figure, picture_colors, pyplot  # needs matplotlib, as nothing else here does
    with picture_colors(), pyplot.rc_context({"svg.hashsalt": "conelane"}):
        figure, axes = new_figure(3.6, 6.4)
        for (label, color, dashes), of_curve in zip(CURVES.values(), points(stored).values()):
            axes.plot([str(beam) for beam, _ in of_curve], [share for _, share in of_curve], dashes, color=f"conelane:{color}", marker="o", label=label)
        axes.set(title="A wider beam finds higher scores, not better lanes", xlabel="width of the beam [fronts for each 2.5 m of progress]",
                 ylabel="share [%]")
        legend(axes)
        stream = io.StringIO()
        figure.savefig(stream, format="svg", facecolor=SURFACE, metadata={"Date": None, "Description": json.dumps(points(stored))})
    return stream.getvalue()
