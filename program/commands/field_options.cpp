#include "program/commands/field_options.hpp"

#include "experiments/options/shared_options.hpp"

#include <cmath>
#include <type_traits>

#include <CLI/CLI.hpp>

namespace conelane::experiments {

void add_field_options(CLI::App& command, const OptionFields& fields) {
    for (const OptionField& field : fields) {
        const std::string name = field.option;
        if (name.empty()) continue;
        std::visit(
            [&](const auto& value) {
                using Value = std::decay_t<decltype(value)>;
                if constexpr (std::is_same_v<Value, bool*>) {
                    command.add_flag(name, *value, field.help);
                } else if constexpr (std::is_same_v<Value, std::string*>) {
                    command.add_option(name, *value, field.help);
                } else if constexpr (std::is_same_v<Value, std::vector<std::string>*> ||
                                     std::is_same_v<Value, std::vector<double>*>) {
                    CLI::Option* const list = command.add_option(name, *value, field.help)->delimiter(',');
                    if (!value->empty()) list->capture_default_str();
                } else if constexpr (!std::is_same_v<Value, const char*>) {
                    CLI::Option* const option =
                        command.add_option(name, *value, field.help)->capture_default_str();
                    if constexpr (std::is_integral_v<std::remove_pointer_t<Value>>) {
                        if (std::isfinite(field.range.most))
                            option->check(whole_number(static_cast<std::size_t>(field.range.least),
                                                       static_cast<std::size_t>(field.range.most)));
                    }
                }
            },
            field.value);
    }
}

}  // namespace conelane::experiments
