#include "graph_search/clc/neighbourhood.hpp"

#include "graph_search/shared/simd_batch.hpp"

#include <cstdint>
#include <limits>

namespace conelane {
namespace {

/// For each of four numbers: all bits set if the condition holds, no bit otherwise.
using Masks [[gnu::vector_size(32)]] = std::int64_t;
static_assert(kDoublesPerBatch <= SearchGraph::kSpare);
constexpr auto kStep = static_cast<std::int64_t>(kDoublesPerBatch);

double sum(const Masks& counts) {
    return -static_cast<double>(counts[0] + counts[1] + counts[2] + counts[3]);
}

CONELANE_SIMD void count(const double* x, const double* y, std::int64_t size, const NewSegment& added,
                         Neighbourhood& result) {
    constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
    const auto& [tip, point, facing, leaves_ends_out] = added;
    const Point left_out = leaves_ends_out ? point : Point(kNowhere, kNowhere);
    const Point left_out_too = leaves_ends_out ? facing : Point(kNowhere, kNowhere);
    const Point segment = point - tip;
    const double segment_m = segment.norm();
    const Point direction = segment / segment_m;
    const Point to_facing = facing - tip;
    const Point facing_to_point = point - facing;
    const double direction_x = direction.x();
    const double direction_y = direction.y();
    Masks inside{};
    Masks beside{};
    Masks close{};
    Doubles closeness{};
    Masks number{0, 1, 2, 3};
    for (std::int64_t i = 0; i < size; i += kStep, number += kStep) {
        const Masks is_there = number < size;
        const Doubles px = *reinterpret_cast<const UnalignedDoubles*>(x + i);
        const Doubles py = *reinterpret_cast<const UnalignedDoubles*>(y + i);
        const Doubles from_tip_x = px - tip.x();
        const Doubles from_tip_y = py - tip.y();
        const Doubles from_point_x = px - point.x();
        const Doubles from_point_y = py - point.y();
        const Doubles at_facing = to_facing.x() * from_tip_y - to_facing.y() * from_tip_x;
        const Doubles at_point =
            facing_to_point.x() * (py - facing.y()) - facing_to_point.y() * (px - facing.x());
        const Doubles at_tip = -segment.x() * from_point_y - -segment.y() * from_point_x;
        inside += is_there & (((at_facing > 0.0) & (at_point > 0.0) & (at_tip > 0.0)) |
                              ((at_facing < 0.0) & (at_point < 0.0) & (at_tip < 0.0)));

        const Doubles along_m = from_tip_x * direction_x + from_tip_y * direction_y;
        const Doubles signed_m = direction_x * from_tip_y - direction_y * from_tip_x;
        const Doubles across_m = signed_m < 0.0 ? -signed_m : signed_m;
        const Masks is_left_out = ((px == left_out.x()) & (py == left_out.y())) |
                                  ((px == left_out_too.x()) & (py == left_out_too.y()));
        const Masks is_beside =
            is_there & (along_m > 0.0) & (along_m < segment_m) & (across_m < kBeside_m) & ~is_left_out;
        beside += is_beside;
        close += is_beside & (across_m < kClose_m);
        const Doubles share = across_m / kBeside_m;
        const Doubles weight = (1.0 - share * share) * (1.0 - share * share);
        closeness += is_beside ? weight : Doubles{};
    }
    result = {sum(inside), sum(beside), sum(close),
              closeness[0] + closeness[1] + closeness[2] + closeness[3]};
}

}  // namespace

Neighbourhood neighbourhood(const SearchGraph& graph, Vertex vertex, const NewSegment& added) {
    Neighbourhood result;
    const SearchGraph::Positions neighbours = graph.neighbour_positions(vertex);
    count(neighbours.x, neighbours.y, static_cast<std::int64_t>(neighbours.size), added, result);
    return result;
}

}  // namespace conelane
