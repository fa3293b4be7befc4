"""report RESULTS PAGE PUBLISHED PICTURES TRACKS: RESULTS is the directory of a comparison, PUBLISHED a JSON object with
the papers' figures and the named conditions, PICTURES a folder for the main figures as PNG or empty, TRACKS those
whose laps the viewer shall have, separated by commas, or empty. Anything wrong with the input is one line on
stderr and exit code 2. The caller gives places of its own and puts the files where they are wanted when all is whole."""

import json
import os
import warnings

from .experiments.comparison import by_rate_figure, latency_figure
from .experiments.solvers import times_figure
from .experiments.speed import growth_figure
from .load import Missing, load_results
from .page import render
from .records import run
from .theme import picture_colors, png_of

# The main figures, which are PNG too, for where no page can be shown.
_MAIN = (("usable.png", "Usable lanes", lambda results: by_rate_figure(results, "usable [%]", "usable")),
         ("latency.png", "Latency", latency_figure),
         ("success.png", "Success, as the CLC paper counts", lambda results: by_rate_figure(results, "success [%]", "success")),
         ("iou.png", "Overlap with the ground truth", lambda results: by_rate_figure(results, "mean IoU [%]", "iou")),
         ("growth.png", "Latency by cone-set size", growth_figure))


def pictures(results):
    """(file name, bytes) of each main figure that the results can show; of several conditions, the papers'."""
    made = []
    main = results.under(results.main_condition) if results.samples else None
    figures = [("engines.png", "Time to a proven optimum", times_figure, results)] + [(*one, main) for one in _MAIN if main]
    with picture_colors():
        for name, title, figure_of, shown in figures:
            try:
                figure, axes = figure_of(shown)
            except Missing:
                continue
            axes.set_title(title, loc="left", fontsize=10)
            made.append((name, png_of(figure)))
    return made


def write(path, content):
    with open(path, "wb") as stream:
        stream.write(content)


def main(arguments):
    folder, page, published, picture_folder, tracks = arguments
    warnings.simplefilter("ignore")  # of figures too small for their labels; nobody can do anything about them
    results = load_results(folder)
    if picture_folder:
        os.makedirs(picture_folder, exist_ok=True)
    write(page, render(results, json.loads(published), tuple(filter(None, tracks.split(",")))).encode("utf-8"))
    if picture_folder:
        for name, content in pictures(results):
            write(os.path.join(picture_folder, name), content)


if __name__ == "__main__":
    run(main)
