#pragma once

#include "conelane/point.hpp"
#include "model/geometry.hpp"

#include <cmath>
#include <cstdint>
#include <string_view>

#include <boost/random/mersenne_twister.hpp>

namespace conelane {

using SceneGenerator = boost::random::mt19937_64;

/// A generator for one purpose, so that draws for one purpose do not change those for another: FNV-1a over
/// the text, then the finaliser of splitmix64.
inline SceneGenerator generator_for(std::string_view text) {
    std::uint64_t hash = 0xcbf29ce484222325U;
    for (const char c : text) {
        hash ^= static_cast<unsigned char>(c);
        hash *= 0x100000001b3U;
    }
    hash ^= hash >> 30U;
    hash *= 0xbf58476d1ce4e5b9U;
    hash ^= hash >> 27U;
    hash *= 0x94d049bb133111ebU;
    hash ^= hash >> 31U;
    return SceneGenerator(hash);
}

/// Drawn numbers are rounded, because the last bits of sine, cosine and logarithm differ between C libraries.
inline double rounded(double value, double steps_per_unit) {
    return std::round(value * steps_per_unit) / steps_per_unit;
}
inline Point rounded(const Point& point) {
    return {rounded(point.x(), 1e6), rounded(point.y(), 1e6)};
}

/// The closed half disc ahead of a car.
struct HalfDisc {
    Point centre;
    Point heading;
    double radius_m;

    [[nodiscard]] bool contains(const Point& point) const {
        const Point offset = point - centre;
        return heading.dot(offset) >= 0.0 && offset.squaredNorm() <= radius_m * radius_m;
    }
};

}  // namespace conelane
