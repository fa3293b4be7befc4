#include "experiments/options/cone_set_sizes.hpp"

#include "conelane/invalid_input.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

namespace conelane::experiments {
namespace {

std::optional<std::size_t> size_of(const std::string& option, const std::string& text) {
    if (text == "all") return std::nullopt;
    std::size_t size = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, size);
    if (error != std::errc{} || rest != end || size < 1)
        throw InvalidInput(option, "'" + text + "' is neither a number of cones nor all");
    return size;
}

}  // namespace

std::vector<std::optional<std::size_t>> cone_set_sizes(const std::string& option,
                                                       std::span<const std::string> texts) {
    std::vector<std::optional<std::size_t>> sizes;
    for (const std::string& text : texts) {
        const std::optional<std::size_t> size = size_of(option, text);
        if (std::ranges::find(sizes, size) != sizes.end())
            throw InvalidInput(option, "'" + text + "' is there twice");
        sizes.push_back(size);
    }
    return sizes;
}

}  // namespace conelane::experiments
