#pragma once

#include "experiments/training/option_field.hpp"

namespace CLI {
class App;
}

namespace conelane::experiments {

/// Declares the fields that have an option. The values must outlive the command.
void add_field_options(CLI::App& command, const OptionFields& fields);

}  // namespace conelane::experiments
