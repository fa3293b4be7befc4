#include "evaluation/world/track.hpp"

namespace conelane {

TrackBoundaries boundaries(const Track& track) {
    TrackBoundaries result;
    result.closed = track.closed;
    result.driven = track.driven;
    for (const std::size_t index : track.left) result.left.push_back(track.cones[index].position);
    for (const std::size_t index : track.right) result.right.push_back(track.cones[index].position);
    return result;
}

}  // namespace conelane
