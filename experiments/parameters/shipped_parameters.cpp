#include "experiments/parameters/shipped_parameters.hpp"

#include "experiments/files/parameter_file.hpp"
#include "experiments/parameters/parameter_texts.hpp"

#include <algorithm>
#include <string>

namespace conelane::experiments {

std::vector<std::string_view> shipped_rld_parameter_names() {
    std::vector<std::string_view> names;
    for (const ParameterText& text : parameter_texts()) names.push_back(text.name);
    return names;
}

std::optional<RldParameters> shipped_rld_parameters(std::string_view name) {
    const auto text = std::ranges::find(parameter_texts(), name, &ParameterText::name);
    if (text == parameter_texts().end()) return std::nullopt;
    return parse_rld_parameters(text->json, std::string(name) + ".json");
}

}  // namespace conelane::experiments
