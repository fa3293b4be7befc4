#include "experiments/training/track_variant.hpp"

#include "evaluation/seeded_random.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

constexpr double kMaxLogStretch = 0.15;

}  // namespace

Track track_variant(Track track, std::size_t number, std::uint64_t seed) {
    track.name += fmt::format("_variant{}", number);
    track.frames.clear();  // a variant of a run is a course
    track.driven.clear();
    boost::random::mt19937_64 random = generator_of(track.name, seed);
    const double axis_rad = boost::random::uniform_real_distribution<double>(0.0, std::numbers::pi)(random);
    boost::random::uniform_real_distribution<double> log_stretch(-kMaxLogStretch, kMaxLogStretch);
    const double along = std::exp(log_stretch(random));
    const double across = std::exp(log_stretch(random));
    const Point axis(std::cos(axis_rad), std::sin(axis_rad));
    const Point normal(-axis.y(), axis.x());
    for (Cone& cone : track.cones) {
        cone.position = along * axis.dot(cone.position) * axis + across * normal.dot(cone.position) * normal;
    }
    if (number % 2 == 0) {
        std::swap(track.left, track.right);
        std::ranges::reverse(track.left);
        std::ranges::reverse(track.right);
    }
    return track;
}

}  // namespace conelane::experiments
