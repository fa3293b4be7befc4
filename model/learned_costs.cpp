#include "conelane/learned_costs.hpp"

#include "conelane/invalid_input.hpp"
#include "model/learned_features.hpp"

namespace conelane {
namespace {

constexpr double kMaxWeight = 1e6;
constexpr std::size_t kMaxUnits = 256;

constexpr std::array<LearnedFeature, kEdgeFeatures> kEdge{{
    {"one", "1", "1 for each edge"},
    {"spacing", "1", "the spacing cost (18), at most 7"},
    {"heading", "1", "the heading cost (25), at most 4"},
    {"facing", "1", "no edge like it a lane's width away, see w_v"},
    {"facing_any_width", "1", "no edge along it at 2.5 to 5.5 m on either side"},
    {"gap", "3 m", "longer than 5 m: a cone may be missing"},
    {"stretch", "d_t", "its length differs from d_e"},
    {"beside", "1", "cones close beside it, which it would skip"},
    {"crowd", "2", "cones within 3.5 m of its midpoint"},
    {"in_lane", "1", "cones at 0.6 to 2.6 m on both sides: on neither is an empty lane"},
    {"distance", "30 m", "its midpoint is far from the car"},
    {"aside", "1", "it is beside the car's axis, as a sine"},
    {"color_cost", "1", "its cones differ in colour, or are on the wrong side"},
    {"same_color", "1", "both cones are blue, or both are yellow"},
    {"doubt", "1", "one less the product of its cones' confidences"},
}};
constexpr std::array<LearnedFeature, kTurnFeatures> kTurn{{
    {"one", "1", "1 for each turn"},
    {"angle_cost", "1", "the angle cost (20), at most 4"},
    {"unevenness", "1", "its edges differ in length, see w_u; at most 4"},
    {"angle", "theta_t", "how far it is from theta_e"},
    {"squared_angle", "theta_t^2", "the same, squared"},
    {"inside", "1", "cones in the triangle that it cuts off"},
    {"length", "8 m", "both edges together"},
    {"gap", "3 m", "what its edges have beyond 5 m"},
    {"bent_gap", "1", "angle times gap: a cone may be missing in a bend"},
    {"facing", "1", "mean of both edges' facing costs"},
    {"facing_change", "1", "one edge has a partner across and the other has none"},
    {"crowd", "2", "cones within 3.5 m of its middle cone"},
    {"distance", "30 m", "its middle cone is far from the car"},
    {"curvature", "0.2/m", "of the circle through its three cones"},
}};
constexpr std::array<LearnedFeature, kNearEndFeatures> kNearEnd{{
    {"one", "1", "1 for each near end"},
    {"fit", "1", "half a lane beside the car's axis, see w_n"},
    {"off", "d_t", "not half a lane beside the car's axis"},
    {"ahead", "6 m", "ahead of the car; negative behind it"},
    {"distance", "6 m", "far from the car"},
    {"behind", "1", "cones from which the boundary may have come"},
    {"crowd", "2", "cones within 3.5 m"},
}};
constexpr std::array<LearnedFeature, kFarEndFeatures> kFarEnd{{
    {"one", "1", "1 for each far end"},
    {"distance", "30 m", "far from the car"},
    {"in_view", "10 m", "far inside the edge of view"},
    {"beyond", "1", "cones by which the boundary may go on"},
    {"crowd", "2", "cones within 3.5 m"},
    {"aside", "1", "beside the car's axis, as a sine"},
}};

}  // namespace

std::string_view to_string(LearnedPart part) {
    constexpr std::array<std::string_view, kLearnedParts.size()> kNames{"edge", "turn", "near_end",
                                                                        "far_end"};
    return kNames[static_cast<std::size_t>(part)];
}

std::span<const LearnedFeature> learned_features(LearnedPart part) {
    static constexpr std::array<std::span<const LearnedFeature>, 4> kOfPart{kEdge, kTurn, kNearEnd, kFarEnd};
    return kOfPart[static_cast<std::size_t>(part)];
}

double LearnedNetwork::operator()(std::span<const double> features) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < features.size(); ++i) sum += linear[i] * features[i];
    if (output.empty()) return sum;
    std::array<double, kMaxUnits> unit;  // the first `count` only
    const std::size_t count = output.size();
    std::fill_n(unit.begin(), count, 0.0);
    for (std::size_t i = 0; i < features.size(); ++i) {
        const double* const row = hidden.data() + i * count;
        const double feature = features[i];
        for (std::size_t u = 0; u < count; ++u) unit[u] += row[u] * feature;
    }
    for (std::size_t u = 0; u < count; ++u) sum += output[u] * std::max(0.0, unit[u]);
    return sum;
}

LearnedNetwork LearnedNetwork::zero(std::size_t features, std::size_t units) {
    return {std::vector<double>(features, 0.0), std::vector<double>(features * units, 0.0),
            std::vector<double>(units, 0.0)};
}

void validate(const LearnedNetwork& network, std::string_view name, std::size_t features) {
    const auto require = [&](const std::vector<double>& numbers, std::size_t size, const char* list) {
        const std::string key = std::string(name) + "." + list;
        if (numbers.size() != size)
            throw InvalidInput(
                key, "must have " + std::to_string(size) + " numbers, not " + std::to_string(numbers.size()));
        if (!std::ranges::all_of(numbers, [](double w) { return std::abs(w) <= kMaxWeight; }))
            throw InvalidInput(key, "must hold numbers between -1e6 and 1e6");
    };
    require(network.linear, features, "linear");
    if (network.units() > kMaxUnits)
        throw InvalidInput(std::string(name) + ".output",
                           "must have at most " + std::to_string(kMaxUnits) + " numbers");
    require(network.output, network.units(), "output");
    require(network.hidden, features * network.units(), "hidden");
}

}  // namespace conelane
