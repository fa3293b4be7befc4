"""docs/learned-costs.svg: usable lanes, IoU and scenes with the highest score against the width of the beam."""

WIDTH, HEIGHT = 640, 360
LEFT, RIGHT, TOP, BOTTOM = 80, 600, 60, 280
TEXT, GREY, LINE = "#1c2024", "#646b73", "#e2e2e0"
# key of a row, label, colour, dashes, where its legend begins
CURVES = [("best_score", "scenes with the highest score found", "#646b73", "5 4", 70), ("first_usable", "usable lanes, by score", "#9a7d0a", "", 345),
          ("iou", "IoU", "#7a00cc", "2 3", 535)]


def rows_of(stored):
    return [row for row in stored.get("rows", []) if row["table"] == "beam"]


def has_figures(stored):
    return bool(rows_of(stored))


def text(x, y, content, anchor="middle", size=12, fill=GREY, more=""):
    return f'<text x="{x}" y="{y}" text-anchor="{anchor}" font-size="{size}" fill="{fill}"{more}>{content}</text>'


def picture(stored):
    rows = rows_of(stored)
    shares = [100 * row[key] for row in rows for key, *_ in CURVES]
    least = min(96, 4 * int(min(shares) // 4))
    height = (BOTTOM - TOP) / (100 - least)
    step = (RIGHT - LEFT) / len(rows)

    def y(share):
        return f"{BOTTOM - height * (share - least):.1f}"

    def x(place):
        return f"{LEFT + step * (place + 0.5):.1f}"

    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" '
             'font-family="DejaVu Sans, sans-serif" font-size="13" role="img">',
             "<title>Usable lanes, IoU and scenes with the highest score against the width of the beam</title>",
             f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fcfcfb"/>',
             text(WIDTH / 2, 28, "A wider beam finds higher scores, not better lanes", size=16, fill=TEXT)]
    for share in range(least, 101, 4):
        lines.append(f'<line x1="{LEFT}" x2="{RIGHT}" y1="{y(share)}" y2="{y(share)}" stroke="{LINE}"/>' + text(LEFT - 8, f"{float(y(share)) + 4:.1f}", share, "end"))
    lines += [text(x(place), BOTTOM + 20, row["beam"]) for place, row in enumerate(rows)]
    middle = f"{(TOP + BOTTOM) / 2:.1f}"
    lines += [text((LEFT + RIGHT) / 2, 322, "width of the beam [fronts for each 2.5 m of progress]", size=13),
              text(22, middle, "share [%]", size=13, more=f' transform="rotate(-90 22 {middle})"')]
    for key, label, colour, dashes, begin in CURVES:
        points = [(x(place), y(100 * row[key])) for place, row in enumerate(rows)]
        stroke = f'stroke="{colour}" stroke-width="2.5" stroke-dasharray="{dashes}"'
        lines.append(f'<polyline points="{" ".join(",".join(point) for point in points)}" fill="none" {stroke}/>')
        lines += [f'<circle cx="{at[0]}" cy="{at[1]}" r="4" fill="{colour}"/>' for at in points]
        lines.append(f'<line x1="{begin}" x2="{begin + 26}" y1="345" y2="345" {stroke}/>' + text(begin + 32, 349, label, "start", fill=TEXT))
    return "\n".join(lines + ["</svg>", ""])
