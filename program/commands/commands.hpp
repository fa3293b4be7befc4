#pragma once

#include "experiments/options/shared_options.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace conelane::learning {}

/// The sub-commands of the program `conelane`, a file each, and the headers that all of them need. `add_X`
/// declares the options of X; the callback runs it. An exception of a command becomes one line on stderr and
/// exit code 2.
namespace conelane::program {

using namespace experiments;  // whose parts the commands call
using namespace learning;

void add_scenes_command(CLI::App& program);
void add_methods_command(CLI::App& program);
void add_detect_command(CLI::App& program);
void add_solve_command(CLI::App& program);
void add_check_command(CLI::App& program);
void add_cross_check_command(CLI::App& study);  ///< a sub-command of `study`
void add_certify_command(CLI::App& program);
void add_export_command(CLI::App& program);
void add_instances_command(CLI::App& program);
void add_drive_command(CLI::App& program);
void add_study_command(CLI::App& program);
void add_score_command(CLI::App& program);
void add_compare_command(CLI::App& program);
void add_cross_validate_command(CLI::App& program);
void add_race_command(CLI::App& program);
void add_report_command(CLI::App& program);
void add_plot_command(CLI::App& program);
void add_train_command(CLI::App& program);
void add_tune_command(CLI::App& program);

}  // namespace conelane::program
