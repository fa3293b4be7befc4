"""backends.jsonl: every solve of `conelane study backends`."""

import os

import numpy as np

from .load import read_lines, require

FILE = "backends.jsonl"
AGREEMENT = 1e-6
_WARM = " warm"


class Solves:
    """The solves of one backend at one cone-set size, columns as arrays of one length. `origin` is a sentence where
    they come from another commit than the comparison."""

    def __init__(self, nearest, backend, rows, origin):
        self.nearest, self.backend, self.origin = nearest, backend, origin
        self.scene = np.array([row["scene"] for row in rows], dtype=object)
        self.track = np.array([row["track"] for row in rows], dtype=object)
        self.status = np.array([row["status"] for row in rows], dtype=object)
        self.objective = np.array([row.get("objective", np.nan) for row in rows], dtype=float)
        self.nodes = np.array([row["nodes"] for row in rows], dtype=float)
        self.latency = np.array([row["latency_ms"] for row in rows], dtype=float)

    def __len__(self):
        return len(self.scene)

    @property
    def is_warm(self):
        return self.backend.endswith(_WARM)

    @property
    def cold_backend(self):
        return self.backend.removesuffix(_WARM)

    @property
    def is_decided(self):
        """Optimum or infeasibility proven."""
        return np.isin(self.status, ("optimal", "infeasible"))


def read(results):
    """By size and backend in the order of the file; empty where there is none."""
    path = results.path(FILE)
    if not os.path.exists(path):
        return []
    rows = {}
    for number, row in read_lines(path):
        if "row" in row or row.get("permutation", 0):  # measures, and the same scene in another order
            continue
        for key, kinds in (("scene", (str,)), ("track", (str,)), ("nearest", (int,)), ("backend", (str,)),
                           ("status", (str,)), ("nodes", (int,)), ("latency_ms", (int, float))):
            require(path, number, row, key, kinds)
        if row["status"] == "optimal":
            require(path, number, row, "objective", (int, float))
        rows.setdefault((row["nearest"], row["backend"]), []).append(row)
    return [Solves(nearest, backend, of_backend, results.origin(of_backend[0]))
            for (nearest, backend), of_backend in rows.items()]


def measures(results, kind):
    """The rows of one kind that the study worked out: block, summary, pair, selection or gap; each with its number."""
    path = results.path(FILE)
    if not os.path.exists(path):
        return []
    return [(number, row) for number, row in read_lines(path) if row.get("row") == kind]


def size_name(nearest):
    """`nearest` of a row: 0 stands for all visible cones."""
    return str(nearest) if nearest else "all"


def size_order(nearest):
    """What tables sort sizes by: all visible cones are the last."""
    return nearest or 10**6


def disagreements(solves):
    """Scenes of one size in which two backends prove different optima, or one proves that there is none where
    another proves an optimum; and the number of scenes that two of them decided."""
    found = {}
    for one in solves:
        for scene, status, objective in zip(one.scene, one.status, one.objective):
            if status in ("optimal", "infeasible"):
                found.setdefault(scene, []).append(objective if status == "optimal" else np.inf)
    shared = [values for values in found.values() if len(values) > 1]
    return sum(not (max(values) == min(values) or max(values) - min(values) <= AGREEMENT) for values in shared), len(
        shared)
