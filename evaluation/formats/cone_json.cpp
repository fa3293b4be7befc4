#include "evaluation/formats/cone_json.hpp"

#include "model/position_covariance.hpp"

#include <cmath>
#include <cstddef>

namespace conelane {
namespace {

constexpr std::array kColors{ConeColor::blue, ConeColor::yellow, ConeColor::orange, ConeColor::big_orange,
                             ConeColor::unknown};
constexpr std::size_t kClasses = 5;

}  // namespace

void ConeColors::read(const JsonNode& json, Cone& cone) {
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

void ConeColors::put(nlohmann::ordered_json& json, const Cone& cone, const std::string& /*place*/) {
    json["color"] = to_string(cone.color);
}

void ConeUncertainty::read(const JsonNode& json, Cone& cone) {
    const auto rows = json.find("position_covariance");
    if (!rows) return;
    constexpr std::size_t kSize = 2;
    if (rows->array_size() != kSize) rows->fail("must be [[xx, xy], [xy, yy]]");
    std::array<double, kSize * kSize> matrix{};
    for (std::size_t row = 0; row < kSize; ++row) {
        if (rows->element(row).array_size() != kSize) rows->fail("must be [[xx, xy], [xy, yy]]");
        for (std::size_t column = 0; column < kSize; ++column)
            matrix[kSize * row + column] = rows->element(row).element(column).number();
    }
    cone.position_covariance = covariance_of(matrix);
    if (!cone.position_covariance) rows->fail("must be symmetric");
    if (!cone.position_covariance->is_valid()) rows->fail("must be positive semidefinite");
}

void ConeUncertainty::put(nlohmann::ordered_json& json, const Cone& cone, const std::string& /*place*/) {
    using nlohmann::ordered_json;
    if (const auto& of = cone.color_probabilities)
        json["color_probabilities"] = {of->unknown, of->blue, of->yellow, of->orange, of->big_orange};
    if (const auto& of = cone.position_covariance) {
        json["position_covariance"] = ordered_json::array(
            {ordered_json::array({of->xx_m2, of->xy_m2}), ordered_json::array({of->xy_m2, of->yy_m2})});
    }
}

}  // namespace conelane
