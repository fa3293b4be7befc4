"""The experiments by the sections of the page that show them."""

from .clc_paper import clc_fig_9, clc_fig_11, clc_fig_12, clc_fig_15, clc_fig_16, clc_table_1, clc_table_2
from .comparison import by_track, calibration, failure_causes, latency, outcomes, outside, quality, steering
from .exactness import formulations, growth, optimality, relaxations
from .rld_paper import rld_fig_5, rld_fig_6, rld_fig_7
from .solvers import solver_measures, warm_start
from .speed import paired_latency, race, same_cone_set

COMPARISON = (quality, steering, calibration, latency, outcomes, by_track, outside)
RACE = (race,)
SPEED = (same_cone_set, paired_latency)  # of one condition, like all that follow
FAILURES = (failure_causes,)
EXACTNESS = (optimality, solver_measures, growth, warm_start, formulations, relaxations)
RLD_PAPER = (rld_fig_5, rld_fig_6, rld_fig_7)
CLC_PAPER = (clc_table_1, clc_table_2, clc_fig_9, clc_fig_11, clc_fig_12, clc_fig_15, clc_fig_16)
