"""The experiments by the sections of the page that show them."""

from . import (anytime, by_track, calibration, clc_fig_9, clc_fig_11, clc_fig_12, clc_fig_15, clc_fig_16, clc_table_1,
               clc_table_2, confidence_and_colour, exact_backends, failure_causes, formulations, growth, latency,
               optimality, outcomes, outside, paired_latency, performance_profiles, quality, race, relaxations, rld_fig_5,
               rld_fig_6, rld_fig_7, same_cone_set, solver_measures, steering, update_or_rebuild, warm_start)

COMPARISON = (quality, steering, calibration, latency, outcomes, by_track, outside)
RACE = (race,)
SPEED = (same_cone_set, paired_latency, performance_profiles)  # of one condition, like all that follow
FAILURES = (failure_causes,)
EXACTNESS = (optimality, exact_backends, solver_measures, anytime, growth, warm_start, formulations, update_or_rebuild, relaxations)
RLD_PAPER = (rld_fig_5, rld_fig_6, rld_fig_7, confidence_and_colour)
CLC_PAPER = (clc_table_1, clc_table_2, clc_fig_9, clc_fig_11, clc_fig_12, clc_fig_15, clc_fig_16)
