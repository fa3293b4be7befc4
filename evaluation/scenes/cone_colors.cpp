#include "evaluation/scenes/cone_colors.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace conelane {
namespace {

constexpr std::array kColors{ConeColor::blue, ConeColor::yellow, ConeColor::orange, ConeColor::big_orange,
                             ConeColor::unknown};
constexpr std::size_t kClasses = 5;

}  // namespace

void read_color(const JsonNode& json, Cone& cone) {
    if (const auto list = json.find("color_probabilities")) {
        if (list->array_size() != kClasses)
            list->fail("must hold 5 numbers: unknown, blue, yellow, orange, big orange");
        std::array<double, kClasses> values{};
        double sum = 0.0;
        for (std::size_t i = 0; i < kClasses; ++i) {
            values[i] = list->element(i).number_in(0.0, 1.0);
            sum += values[i];
        }
        constexpr double kOff = 1e-3;  // the same as in validate(Scene)
        if (std::abs(sum - 1.0) > kOff) list->fail("must add up to 1");
        cone.color_probabilities = ColorProbabilities{values[0], values[1], values[2], values[3], values[4]};
        cone.color = most_probable_color(*cone.color_probabilities);
    }
    if (const auto color = json.find("color")) cone.color = color->one_of(kColors);
}

nlohmann::ordered_json color_probabilities_json(const ColorProbabilities& probabilities) {
    return {probabilities.unknown, probabilities.blue, probabilities.yellow, probabilities.orange,
            probabilities.big_orange};
}

}  // namespace conelane
