#include "detectors/planner/cone_votes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace conelane {
namespace {

enum class Place : std::uint8_t { outside, left, right, inside };

/// Where each cone of a scene is, by a lane. Of a lane of one boundary nothing is inside.
std::vector<Place> places(const Scene& scene, const Lane& lane) {
    std::vector<Place> places(scene.cones.size(), Place::outside);
    std::vector<Point> outline;
    const auto mark = [&](const std::vector<ConeId>& side, Place place) {
        for (const ConeId id : side) {
            const auto cone = std::ranges::lower_bound(scene.cones, id, {}, &Cone::id);
            if (cone == scene.cones.end() || cone->id != id) continue;
            places[static_cast<std::size_t>(cone - scene.cones.begin())] = place;
            outline.push_back(cone->position);
        }
    };
    mark(lane.left, Place::left);
    std::ranges::reverse(outline);
    const std::size_t left = outline.size();
    mark(lane.right, Place::right);
    if (left < 2 || outline.size() - left < 2) return places;
    Point low = outline.front();
    Point high = low;
    for (const Point& point : outline) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Point& at = scene.cones[i].position;
        if (places[i] != Place::outside || (at.array() < low.array()).any() ||
            (at.array() > high.array()).any()) {
            continue;
        }
        bool inside = false;
        for (std::size_t a = 0, b = outline.size() - 1; a < outline.size(); b = a++) {
            const Point& from = outline[a];
            const Point& to = outline[b];
            if ((from.y() > at.y()) != (to.y() > at.y()) &&
                at.x() < (to.x() - from.x()) * (at.y() - from.y()) / (to.y() - from.y()) + from.x()) {
                inside = !inside;
            }
        }
        if (inside) places[i] = Place::inside;
    }
    return places;
}

}  // namespace

double ConeVotes::share(const Pose& pose, const Point& cone) const {
    const double distance_m = (cone - pose.position).norm();
    return std::clamp((settings_.far_m - distance_m) / (settings_.far_m - settings_.near_m), 0.0, 1.0);
}

void ConeVotes::vote(const Scene& scene, std::span<const VotedLane> lanes) {
    std::vector<VotedCone> said;
    for (const Cone& cone : scene.cones) said.push_back({cone.id});
    for (const VotedLane& voted : lanes) {
        const std::vector<Place> where = places(scene, *voted.lane);
        for (std::size_t i = 0; i < where.size(); ++i) {
            if (where[i] == Place::outside) continue;
            double& vote = where[i] == Place::left    ? said[i].left
                           : where[i] == Place::right ? said[i].right
                                                      : said[i].inside;
            vote = std::max(vote, voted.weight);
        }
    }
    std::vector<VotedCone> next;
    auto known = cones_.begin();
    for (std::size_t i = 0; i < said.size(); ++i) {
        VotedCone cone = said[i];
        const double weight = share(scene.pose, scene.cones[i].position);
        cone.left *= weight;
        cone.right *= weight;
        cone.inside *= weight;
        while (known != cones_.end() && known->id < cone.id) ++known;
        if (known != cones_.end() && known->id == cone.id) {
            // Frames that are uncertain replace little of what surer ones have said.
            const double kept = 1.0 - settings_.fading * std::max({cone.left, cone.right, cone.inside});
            cone.left += kept * known->left;
            cone.right += kept * known->right;
            cone.inside += kept * known->inside;
        }
        if (cone.left + cone.right + cone.inside > settings_.min_votes) next.push_back(cone);
    }
    cones_ = std::move(next);
}

double ConeVotes::objection(const Scene& scene, const Lane& lane) const {
    const std::vector<Place> where = places(scene, lane);
    double sum = 0.0;
    auto known = cones_.begin();
    for (std::size_t i = 0; i < where.size(); ++i) {
        if (where[i] == Place::outside) continue;
        while (known != cones_.end() && known->id < scene.cones[i].id) ++known;
        if (known == cones_.end()) break;
        if (known->id != scene.cones[i].id) continue;
        const auto against = [&](double votes, double other, double another) {
            return std::log((std::max(other, another) + settings_.prior) / (votes + settings_.prior));
        };
        const double odds = where[i] == Place::left    ? against(known->left, known->right, known->inside)
                            : where[i] == Place::right ? against(known->right, known->left, known->inside)
                                                       : against(known->inside, known->left, known->right);
        sum += share(scene.pose, scene.cones[i].position) * std::max(0.0, odds);
    }
    return std::min(settings_.max_objection, sum);
}

}  // namespace conelane
