#include "experiments/options/whole_number.hpp"

#include <charconv>
#include <string>
#include <system_error>

#include <fmt/format.h>

namespace conelane::experiments {

CLI::Validator whole_number(std::size_t least, std::size_t most) {
    const auto fault = [least, most](const std::string& text) -> std::string {
        std::size_t number = 0;
        const char* const end = text.data() + text.size();
        const auto [rest, error] = std::from_chars(text.data(), end, number);
        if (error == std::errc{} && rest == end && number >= least && number <= most) return {};
        return fmt::format("'{}' is not a whole number from {} to {}", text, least, most);
    };
    return {fault, fmt::format("in [{} - {}]", least, most)};
}

}  // namespace conelane::experiments
