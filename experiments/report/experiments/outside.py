"""Methods from outside

Claim: Which of these methods are not this project's, and how do their authors describe them?
Protocol: a program answers scene by scene through a pipe; its latency is the whole round trip; that of an echo \
program is shown for comparison. Self-timed: the time that the method itself reports. All latencies of a finished lanes \
file are self-timed. The other columns are from the method's own card.
Source: this project; the cards are their authors'.
Command: conelane compare --methods exec:NAME=COMMAND,lanes:NAME=FILE --out RESULTS
"""

from ..experiment import Missing
from ..tables import Cell, Column, method_cell, milliseconds, table, text

_KINDS = {"exec": "program", "lanes": "lanes file", "solver": "RLD by a solver"}


def _yes_or_no(value):
    return Cell("–") if value is None else text("yes" if value else "no")


def _time(times, key):
    return milliseconds(times[key]) if isinstance(times, dict) and key in times else Cell("–")


def html(results, published):
    rows = []
    for row in results.rows:
        if "outside" not in row or any(row["method"] == shown[0].text for shown in rows):
            continue
        card = row.get("card", {})
        texts = [text(str(card[key])) if key in card else Cell("–") for key in ("name", "address", "licence")]
        rows.append([method_cell(results.methods, row["method"], row["method"]),
                     text(_KINDS.get(row["outside"], str(row["outside"])))] + texts +
                    [_yes_or_no(card.get(key)) for key in ("colour_used", "history_used")] +
                    [text(", ".join(map(str, card["training_courses"])) or "none") if "training_courses" in card
                     else Cell("–"), _time(row.get("self_timed_ms"), "median"), _time(row.get("self_timed_ms"), "p95"),
                     _time(row.get("echo_floor_ms"), "median")])
    if not rows:
        raise Missing("no method from outside took part.")
    columns = [Column(title, "text") for title in ("method", "kind", "name", "address", "licence", "uses colour",
                                                   "uses history", "trained on")] + [
        Column("self-timed median ms"), Column("self-timed p95 ms"), Column("echo median ms")]
    return table("outside", "", columns, rows, note="Times: of the first condition, rate and range of each.")
