#pragma once

#include "model/strip_costs.hpp"

#include <filesystem>
#include <memory>
#include <string>

namespace conelane {

/// Calls use(key, numbers) for each list of numbers, in the order of files.
template <typename Costs, typename Use>
void for_each_costs_list(Costs& costs, const Use& use) {
    for (const auto part : Costs::kParts) {
        const std::string name(to_string(part));
        use(name + "_linear", costs.of(part).linear);
        use(name + "_hidden", costs.of(part).hidden);
        use(name + "_output", costs.of(part).output);
    }
}

/// Learned costs from the bytes of a file that `conelane train rld --out FILE` wrote: a JSON object with
/// `version` 1, `features`, the names of the features of each part as the library has them, and for each part
/// its lists of numbers, such as `edge_linear`, `edge_hidden` and `edge_output`. A network without hidden
/// units has two empty lists. Throws InvalidInput naming the key, or the line that is not JSON.
[[nodiscard]] std::shared_ptr<const LearnedCosts> parse_learned_costs(std::string_view text);

/// The same from a file. Throws InvalidInput naming the file too, also if it cannot be read.
[[nodiscard]] std::shared_ptr<const LearnedCosts> read_learned_costs(const std::filesystem::path& file);

// The same of the costs of the strip program, which `conelane train strip` writes.
[[nodiscard]] std::shared_ptr<const StripCosts> parse_strip_costs(std::string_view text);
[[nodiscard]] std::shared_ptr<const StripCosts> read_strip_costs(const std::filesystem::path& file);

}  // namespace conelane
