#include "graph_search/baselines/delaunay_beam/delaunay_triangulation.hpp"

#include <algorithm>
#include <cmath>

namespace conelane {
namespace {

/// Half the extent of the points in grid units. Differences then have 31 bits, and the sum of four products
/// in in_circle has 124.
constexpr double kGridRadius = 536870912.0;

__extension__ using Wide = __int128;

int sign(Wide value) {
    return static_cast<int>(value > 0) - static_cast<int>(value < 0);
}

/// 1 if c is to the left of the line from a to b, -1 to the right, 0 on it.
template <typename Site>
int orientation(const Site& a, const Site& b, const Site& c) {
    return sign(Wide{b.x - a.x} * (c.y - a.y) - Wide{b.y - a.y} * (c.x - a.x));
}

/// 1 if d is inside the circumcircle of the counter-clockwise triangle abc, 0 on it.
template <typename Site>
int in_circle(const Site& a, const Site& b, const Site& c, const Site& d) {
    const Wide ax = a.x - d.x, ay = a.y - d.y;
    const Wide bx = b.x - d.x, by = b.y - d.y;
    const Wide cx = c.x - d.x, cy = c.y - d.y;
    return sign((ax * ax + ay * ay) * (bx * cy - by * cx) + (bx * bx + by * by) * (cx * ay - cy * ax) +
                (cx * cx + cy * cy) * (ax * by - ay * bx));
}

}  // namespace

void DelaunayTriangulation::place_sites(std::span<const Point> points) {
    sites_.clear();
    if (points.empty()) return;
    Point lowest = points.front();
    Point highest = points.front();
    for (const Point& point : points) {
        lowest = lowest.cwiseMin(point);
        highest = highest.cwiseMax(point);
    }
    // Halved first, because the sum of two finite numbers may be infinite.
    const Point centre = 0.5 * lowest + 0.5 * highest;
    const double radius =
        std::max((0.5 * highest - 0.5 * lowest).maxCoeff(), std::numeric_limits<double>::min());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Point units = kGridRadius * ((points[i] - centre) / radius);
        sites_.push_back({std::llround(units.x()), std::llround(units.y()), static_cast<Vertex>(i)});
    }
    std::ranges::sort(sites_);
    const auto same_place = [](const Site& a, const Site& b) { return a.x == b.x && a.y == b.y; };
    sites_.erase(std::unique(sites_.begin(), sites_.end(), same_place), sites_.end());
}

DelaunayTriangulation::HalfEdge DelaunayTriangulation::add_triangle(SiteIndex a, SiteIndex b, SiteIndex c) {
    const auto first = static_cast<HalfEdge>(origin_.size());
    origin_.insert(origin_.end(), {a, b, c});
    twin_.insert(twin_.end(), 3, kNone);
    return first;
}

void DelaunayTriangulation::join(HalfEdge side, HalfEdge twin) {
    twin_[side] = twin;
    if (twin == kNone) {
        hull_side_[origin_[side]] = side;
    } else {
        twin_[twin] = side;
    }
}

/// All sites before `apex` are on one line, and `apex` is not.
void DelaunayTriangulation::join_first_triangles(SiteIndex apex) {
    const bool left = orientation(sites_[0], sites_[1], sites_[apex]) > 0;
    HalfEdge shared = kNone;  // the side that the previous triangle shares with the next one
    for (SiteIndex i = 0; i + 1 < apex; ++i) {
        const HalfEdge base = left ? add_triangle(i, i + 1, apex) : add_triangle(i + 1, i, apex);
        // Counter-clockwise, the sides to and from the apex follow the base.
        const HalfEdge before = left ? base + 2 : base + 1;
        const HalfEdge after = left ? base + 1 : base + 2;
        join(base, kNone);
        join(before, shared);
        shared = after;
    }
    join(shared, kNone);
    const auto follow = [this](SiteIndex from, SiteIndex to) {
        hull_next_[from] = to;
        hull_previous_[to] = from;
    };
    for (SiteIndex i = 0; i + 1 < apex; ++i) left ? follow(i, i + 1) : follow(i + 1, i);
    left ? follow(apex - 1, apex) : follow(apex, apex - 1);
    left ? follow(apex, 0) : follow(0, apex);
}

/// Sites come in ascending order, so this one is outside the hull and sees a side at the site before it.
void DelaunayTriangulation::insert(SiteIndex site) {
    const auto sees = [&](SiteIndex from, SiteIndex to) {
        return orientation(sites_[from], sites_[to], sites_[site]) < 0;
    };
    SiteIndex first = site - 1;
    SiteIndex last = site - 1;
    while (sees(hull_previous_[first], first)) first = hull_previous_[first];
    while (sees(last, hull_next_[last])) last = hull_next_[last];
    HalfEdge shared = kNone;
    for (SiteIndex from = first; from != last; from = hull_next_[from]) {
        const HalfEdge seen = hull_side_[from];
        const HalfEdge to_site = add_triangle(from, site, hull_next_[from]);
        join(to_site + 2, seen);
        join(to_site, shared);
        shared = to_site + 1;
        unsettled_.push_back(to_site + 2);
    }
    join(shared, kNone);
    hull_next_[first] = site;
    hull_previous_[site] = first;
    hull_next_[site] = last;
    hull_previous_[last] = site;
}

std::size_t DelaunayTriangulation::settle() {
    std::size_t tested = 0;
    for (; !unsettled_.empty(); ++tested) {
        // Triangles abc and bad with the sides e = ab, f = ba become adc and dbc.
        const HalfEdge e = unsettled_.back();
        unsettled_.pop_back();
        const HalfEdge f = twin_[e];
        if (f == kNone) continue;
        const HalfEdge bc = next(e), ca = next(bc), ad = next(f), db = next(ad);
        const SiteIndex a = origin_[e], b = origin_[f], c = origin_[ca], d = origin_[db];
        if (in_circle(sites_[a], sites_[b], sites_[c], sites_[d]) <= 0) continue;
        const HalfEdge beyond_bc = twin_[bc];
        const HalfEdge beyond_ad = twin_[ad];
        origin_[bc] = d;
        origin_[ad] = c;
        join(e, beyond_ad);
        join(f, beyond_bc);
        join(bc, ad);
        unsettled_.push_back(e);
        unsettled_.push_back(db);
    }
    return tested;
}

bool DelaunayTriangulation::build(std::span<const Point> points, SearchBudget& budget) {
    origin_.clear();
    twin_.clear();
    unsettled_.clear();
    place_sites(points);
    if (budget.spend(points.size())) return false;
    hull_next_.assign(sites_.size(), 0);
    hull_previous_.assign(sites_.size(), 0);
    hull_side_.assign(sites_.size(), kNone);
    SiteIndex apex = 2;
    while (apex < sites_.size() && orientation(sites_[0], sites_[1], sites_[apex]) == 0) ++apex;
    if (apex >= sites_.size()) return true;
    join_first_triangles(apex);
    for (SiteIndex site = apex + 1; site < sites_.size(); ++site) {
        insert(site);
        if (budget.spend(5 * settle())) {
            origin_.clear();
            twin_.clear();
            return false;
        }
    }
    return true;
}

}  // namespace conelane
