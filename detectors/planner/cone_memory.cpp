#include "detectors/planner/cone_memory.hpp"

#include "model/geometry.hpp"

#include <tuple>

namespace conelane {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// A seen cone and a remembered one that may be the same.
struct Match {
    double distance_m;
    std::size_t seen;
    std::size_t remembered;
};

double bearing_rad(const Pose& pose, const Point& place) {
    return std::abs(std::atan2(pose.left_m(place), pose.ahead_m(place)));
}

}  // namespace

ConeMemory::ConeMemory(const ConeMemorySettings& settings, const ShiftSettings& shift_settings)
    : settings_(settings), shift_settings_(shift_settings) {}

std::optional<RigidShift> ConeMemory::observe(const Frame& frame) {
    ++frame_;
    pose_ = frame.pose;
    range_m_ = widest_rad_ = 0.0;
    for (const Cone& cone : frame.cones) {
        range_m_ = std::max(range_m_, (cone.position - frame.pose.position).norm());
        widest_rad_ = std::max(widest_rad_, bearing_rad(frame.pose, cone.position));
    }
    const double near_m = std::max(range_m_, settings_.max_range_m) + settings_.same_id_gate_m;
    Indices near;
    for (std::size_t i = 0; i < cones_.size(); ++i) {
        if ((cones_[i].position - frame.pose.position).squaredNorm() <= near_m * near_m) near.push_back(i);
    }
    Indices remembered_of = by_id(frame, near);
    const std::optional<RigidShift> shift = shift_of(frame, near, remembered_of);
    if (shift) {
        for (RememberedCone& cone : cones_) cone.position = (*shift)(cone.position);
    }
    associate(frame, near, remembered_of);
    for (std::size_t k = 0; k < frame.cones.size(); ++k) see(frame.cones[k], remembered_of[k]);
    miss_unseen(near);
    forget();
    return shift;
}

/// For each cone of the frame, the near one that the car gave the same id, or kNone.
ConeMemory::Indices ConeMemory::by_id(const Frame& frame, const Indices& near) const {
    std::vector<std::pair<ConeId, std::size_t>> given;
    for (const std::size_t i : near) {
        if (cones_[i].given != kNoId) given.emplace_back(cones_[i].given, i);
    }
    std::ranges::sort(given);
    Indices remembered_of;
    for (const Cone& cone : frame.cones) {
        const auto known = std::ranges::lower_bound(given, std::pair(cone.id, std::size_t{0}));
        const bool is_known = cone.id != kNoId && known != given.end() && known->first == cone.id;
        remembered_of.push_back(is_known ? known->second : kNone);
    }
    return remembered_of;
}

std::optional<RigidShift> ConeMemory::shift_of(const Frame& frame, const Indices& near,
                                               const Indices& remembered_of) const {
    std::vector<PlacePair> pairs;
    std::size_t unmoved = 0;
    for (std::size_t k = 0; k < frame.cones.size(); ++k) {
        if (remembered_of[k] == kNone) continue;
        const Point& seen = frame.cones[k].position;
        const Point& place = cones_[remembered_of[k]].position;
        const double distance_m = (place - seen).norm();
        if (distance_m <= shift_settings_.reach_m) pairs.push_back({place, seen});
        if (distance_m <= shift_settings_.min_shift_m) ++unmoved;
    }
    if (pairs.size() >= shift_settings_.min_cones && 2 * pairs.size() >= frame.cones.size()) {
        if (2 * unmoved > pairs.size()) return std::nullopt;
        return common_shift(pairs, shift_settings_);
    }
    std::vector<Point> remembered;
    for (const std::size_t i : near) {
        if (cones_[i].sightings > 1) remembered.push_back(cones_[i].position);
    }
    // Only cones near a remembered one can have moved away from it.
    std::vector<Point> compared;
    for (const Cone& cone : frame.cones) {
        double nearest_m = shift_settings_.reach_m;
        for (const Point& other : remembered) nearest_m = std::min(nearest_m, (other - cone.position).norm());
        if (nearest_m < shift_settings_.reach_m) compared.push_back(cone.position);
        if (nearest_m <= shift_settings_.inlier_m) ++unmoved;
    }
    if (3 * unmoved > 2 * compared.size()) return std::nullopt;
    return common_shift(remembered, compared, shift_settings_);
}

/// Leaves out ids whose cones are too far apart, and finds the other cones by their places.
void ConeMemory::associate(const Frame& frame, const Indices& near, Indices& remembered_of) {
    std::vector<bool> taken(cones_.size(), false);
    for (std::size_t k = 0; k < frame.cones.size(); ++k) {
        if (remembered_of[k] == kNone) continue;
        RememberedCone& remembered = cones_[remembered_of[k]];
        if ((remembered.position - frame.cones[k].position).norm() > settings_.same_id_gate_m) {
            remembered.given = kNoId;
            remembered_of[k] = kNone;
        } else {
            taken[remembered_of[k]] = true;
        }
    }
    std::vector<Match> matches;
    for (std::size_t k = 0; k < frame.cones.size(); ++k) {
        if (remembered_of[k] != kNone) continue;
        const double gate_m = frame.cones[k].id == kNoId ? settings_.place_gate_m : settings_.new_id_gate_m;
        for (const std::size_t i : near) {
            if (taken[i]) continue;
            const double distance_m = (cones_[i].position - frame.cones[k].position).norm();
            if (distance_m <= gate_m) matches.push_back({distance_m, k, i});
        }
    }
    // Sorted, so that the order of the cones in the frame only decides between equal distances.
    std::ranges::sort(matches, {}, [](const Match& match) {
        return std::tuple(match.distance_m, match.remembered, match.seen);
    });
    for (const Match& match : matches) {
        if (remembered_of[match.seen] != kNone || taken[match.remembered]) continue;
        remembered_of[match.seen] = match.remembered;
        taken[match.remembered] = true;
    }
}

void ConeMemory::see(const Cone& seen, std::size_t remembered) {
    if (remembered == kNone) {
        cones_.push_back({.id = next_id_++, .position = seen.position, .confidence = seen.confidence});
    } else {
        RememberedCone& cone = cones_[remembered];
        if ((seen.position - cone.position).norm() > settings_.moved_m) cone.sightings = 0;
        ++cone.sightings;
        const double weight = 1.0 / std::min(cone.sightings, settings_.averaged_sightings);
        cone.position += weight * (seen.position - cone.position);
        cone.confidence += weight * (seen.confidence - cone.confidence);
        cone.evidence = std::min(settings_.max_evidence, cone.evidence + 1.0);
    }
    RememberedCone& cone = remembered == kNone ? cones_.back() : cones_[remembered];
    cone.last_seen = frame_;
    if (seen.id != kNoId) cone.given = seen.id;
    ++cone.colors[static_cast<std::size_t>(seen.color)];
}

bool ConeMemory::is_in_sure_view(const Point& place) const {
    const double distance_m = (place - pose_.position).norm();
    return distance_m <= settings_.sure_view_share * range_m_ && distance_m >= settings_.blind_m &&
           bearing_rad(pose_, place) <= settings_.sure_view_share * widest_rad_;
}

void ConeMemory::miss_unseen(const Indices& near) {
    for (const std::size_t i : near) {
        RememberedCone& cone = cones_[i];
        if (cone.last_seen != frame_ && is_in_sure_view(cone.position))
            cone.evidence -= settings_.missed_evidence;
    }
}

void ConeMemory::forget() {
    std::erase_if(cones_, [&](const RememberedCone& cone) {
        if (cone.evidence <= 0.0) return true;
        return cone.sightings == 1 && frame_ - cone.last_seen > settings_.fleeting_frames;
    });
    if (cones_.size() <= settings_.max_cones) return;
    std::vector<std::pair<std::int64_t, ConeId>> oldest;
    for (const RememberedCone& cone : cones_) oldest.emplace_back(cone.last_seen, cone.id);
    const auto first_kept = oldest.begin() + static_cast<std::ptrdiff_t>(cones_.size() - settings_.max_cones);
    std::ranges::nth_element(oldest, first_kept);
    const auto limit = *first_kept;
    std::erase_if(cones_,
                  [&](const RememberedCone& cone) { return std::pair(cone.last_seen, cone.id) < limit; });
}

Scene ConeMemory::scene(const Pose& pose) const {
    Scene scene{"frame", pose, {}};
    // A narrow view shows little in a corner: the cones remembered near the car lead on.
    const bool is_narrow = range_m_ > 0.0 && widest_rad_ < settings_.narrow_rad;
    const double least_m = is_narrow ? settings_.near_m : 0.0;
    const double range_m = std::clamp(range_m_, least_m, settings_.max_range_m);
    std::vector<const RememberedCone*> chosen;
    for (const RememberedCone& cone : cones_) {
        const bool seen_now = cone.last_seen == frame_;
        if (!seen_now && cone.sightings < 2) continue;
        const double distance_m = (cone.position - pose.position).norm();
        const double reach_m = pose.ahead_m(cone.position) >= 0.0 ? range_m : settings_.behind_m;
        if (distance_m <= reach_m) chosen.push_back(&cone);
    }
    // Of cones at one place, the one that was seen most often represents all.
    std::ranges::sort(chosen, {},
                      [](const RememberedCone* cone) { return std::tuple(-cone->sightings, cone->id); });
    std::vector<const RememberedCone*> kept;
    for (const RememberedCone* cone : chosen) {
        const bool doubled = std::ranges::any_of(kept, [&](const RememberedCone* other) {
            return (other->position - cone->position).squaredNorm() <=
                   settings_.doubled_m * settings_.doubled_m;
        });
        if (!doubled) kept.push_back(cone);
    }
    std::ranges::sort(kept, {}, &RememberedCone::id);
    for (const RememberedCone* cone : kept) {
        scene.cones.push_back({cone->id, cone->position, color_of(*cone), cone->confidence});
    }
    return scene;
}

const ConeMemory::RememberedCone* ConeMemory::find(ConeId own) const {
    const auto cone = std::ranges::lower_bound(cones_, own, {}, &RememberedCone::id);
    return cone != cones_.end() && cone->id == own ? &*cone : nullptr;
}

ConeId ConeMemory::given_id(ConeId own) const {
    const RememberedCone* const cone = find(own);
    return cone != nullptr && cone->given != kNoId ? cone->given : own;
}

ConeColor color_of(const ConeMemory::RememberedCone& cone) {
    const auto seen = [&](ConeColor color) { return cone.colors[static_cast<std::size_t>(color)]; };
    const int big = seen(ConeColor::big_orange);
    const int small = seen(ConeColor::orange);
    const std::array<std::pair<int, ConeColor>, 3> counts{
        {{big + small, big >= small ? ConeColor::big_orange : ConeColor::orange},
         {seen(ConeColor::blue), ConeColor::blue},
         {seen(ConeColor::yellow), ConeColor::yellow}}};
    const auto most = std::ranges::max_element(counts, {}, &std::pair<int, ConeColor>::first);
    return most->first > 0 ? most->second : ConeColor::unknown;
}

}  // namespace conelane
