// parameter_fields prints the parameters of the library, a line each, with tabs between the fields: group,
// key, default, lowest, highest, unit, description. tests/docs/reference_pages makes parameters.md of it.
#include "conelane/rld_parameter_sets.hpp"

#include <cstdio>

namespace {

using conelane::RldParameterField;
using conelane::RldParameters;

void print(std::string_view group, std::string_view key, double value, double lowest, double highest,
           std::string_view unit, std::string_view description) {
    std::printf("%s\t%s\t%.6g\t%.6g\t%.6g\t%s\t%s\n", std::string(group).c_str(), std::string(key).c_str(),
                value, lowest, highest, std::string(unit).c_str(), std::string(description).c_str());
}

}  // namespace

int main() {
    const RldParameters defaults;
    for (const RldParameterField& field : conelane::rld_parameter_fields()) {
        print("rld", field.key, defaults.*field.value, field.lowest, field.highest, field.unit,
              field.description);
    }
    for (const RldParameterField& field : conelane::rld_extra_fields()) {
        print("rld extra", field.key, defaults.*field.value, field.lowest, field.highest, field.unit,
              field.description);
    }
    // The columns of the shipped sets: group "set NAME".
    for (const std::string_view name : conelane::rld_parameter_set_names()) {
        const RldParameters set = *conelane::rld_parameter_set(name);
        const std::string group = "set " + std::string(name);
        for (const RldParameterField& field : conelane::rld_parameter_fields())
            print(group, field.key, set.*field.value, field.lowest, field.highest, field.unit, "");
        for (const RldParameterField& field : conelane::rld_extra_fields())
            print(group, field.key, set.*field.value, field.lowest, field.highest, field.unit, "");
    }
}
