"""Drives a recorded run with a planner and makes one page that plays it.

    python -m conelane.replay RUN --out run.html

RUN is a bag (see `conelane.bags`) or a file of frames (*.frames.jsonl, a run of ft-fsd). The page shows cones, lane and trusted
length of each frame, and where there was no lane and why.
"""
from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import Any, Dict, Iterable, Optional, Sequence

import numpy as np

from . import Plan, Planner
from .bags import add_bag_options, reporting, run_of
from .frames import Frame, read_frames
from .page.replay import Replay

__all__ = ["replay"]


def _line(plan: Plan) -> Dict[str, Any]:
    """What `conelane drive --follow` writes of a plan, as far as the page shows it."""
    answer = {key: getattr(plan.answer, key) for key in ("status", "message", "confidence", "stopped_by")}
    return {**{key: getattr(plan, key) for key in ("state", "lap", "phase", "stop", "age_s", "safe_m", "reason")}, "answer": answer,
            "points": plan.centre_line.tolist()}


def replay(frames: Iterable[Optional[Frame]], planner: Planner, name: str = "run", time_limit_ms: Optional[float] = 50.0) -> str:
    """The page of a run, as text of HTML.

    frames: As `read_frames` gives them; None where another run begins.
    planner: Drives the run, with `time_limit_ms` for each frame [ms].
    name: Title of the page.
    Raises ValueError as `Planner.update`, with name and number of the frame, and if `frames` is empty.

    >>> cones = [[x, y] for x in (2, 6, 10, 14) for y in (-1.5, 1.5)]
    >>> page = replay([Frame(cones, (0, 0, 0), 0.0)], Planner())
    >>> "following 100.0 %" in page
    True
    """
    page, count = Replay(), 0
    for number, frame in enumerate(frames, 1):
        if frame is None:
            planner.reset()
            page.reset()
            continue
        count += 1
        try:
            plan = planner.update(**frame._asdict(), time_limit_ms=time_limit_ms)
        except ValueError as error:
            raise ValueError(f"{name}: frame {number}: {error}") from None
        page.add(frame.time_s, frame.pose, np.asarray(frame.cones).tolist(), _line(plan))
    if not count:
        raise ValueError(f"{name}: holds no frame")
    return page.page(name)


def _frames_of(options: argparse.Namespace) -> Iterable[Optional[Frame]]:
    file = Path(options.run)
    if file.suffix in (".json", ".jsonl"):
        return read_frames(file)
    if file.suffix not in (".bag", ".db3", ".mcap") and not file.is_dir():
        raise ValueError(f"{file}: must end in .bag, .db3 or .mcap (a bag), in .jsonl or .json (frames), or be the folder of a ROS 2 bag")
    return run_of(options).frames


def _write(options: argparse.Namespace) -> None:
    half = Path(f"{options.out}.part-{os.getpid()}")
    try:
        planner = Planner(options.mission, options.method, options.laps)
        half.write_text(replay(_frames_of(options), planner, Path(options.run).name), encoding="utf-8")
        half.replace(options.out)
    finally:
        half.unlink(missing_ok=True)


def main(arguments: Optional[Sequence[str]] = None) -> int:
    parser = argparse.ArgumentParser("python -m conelane.replay", description="Makes one page that plays a run.")
    add_bag_options(parser, "; or frames: *.frames.jsonl, or a run of ft-fsd, *.json")
    parser.add_argument("--out", "-o", required=True, help="PAGE.html")
    parser.add_argument("--mission", default="trackdrive", help="trackdrive, autocross, acceleration, skidpad")
    parser.add_argument("--method", default="front-warm", help="the detector")
    parser.add_argument("--laps", type=int, help="of trackdrive and autocross")
    options = parser.parse_args(arguments)
    return reporting(lambda: _write(options))


if __name__ == "__main__":
    sys.exit(main())
