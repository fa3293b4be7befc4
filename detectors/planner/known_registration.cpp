#include "detectors/planner/known_registration.hpp"

#include <functional>
#include <utility>

#include <Eigen/Cholesky>

namespace conelane {
namespace {

constexpr double kMatched_m = 0.45;  ///< a seen cone is on a boundary within this distance
constexpr double kBeside_m = 0.9;    ///< and beside it within this one
constexpr double kColor = 0.2;       ///< gained or lost by a color
constexpr double kMissing = 0.3;     ///< lost by a place that should have a cone in view and has none
constexpr double kMinScore = 4.0;    ///< of a registration that is trusted
constexpr int kMinMatched = 6;
constexpr double kMinMargin = 1.5;  ///< to the next distinct registration
constexpr double kMinMarginShare = 0.2;
constexpr double kDistinct_m = 0.7;  ///< registrations that differ by more, at the car
constexpr double kDistinct_rad = 0.09;

// What is seen.
constexpr double kSameCone_m = 0.45;
constexpr int kAveragedSightings = 20;
constexpr double kForgotten_s = 3.0;
constexpr std::size_t kMaxCones = 600;
constexpr double kMaxDistance_m = 45.0;  ///< cones of a map that are farther from the car are left out
constexpr double kSureShare = 0.8;       ///< of range and bearing: a cone within is in view
constexpr double kBlind_m = 2.0;
constexpr double kMaxBeyond = 1.2;  ///< of the second farthest cone: a farther one may be false

// The search over a grid of poses.
constexpr double kCell_m = 0.25;
constexpr double kNear_m = 0.9;    ///< of a boundary: counts in the search
constexpr double kMargin_m = 2.0;  ///< of the raster around the course
constexpr double kStep_m = 0.4;
constexpr double kStep_rad = 0.035;
constexpr std::size_t kMaxSearched = 80;  ///< cones: the nearest to the car
constexpr std::size_t kMaxCandidates = 16;
constexpr std::size_t kMaxFitted = 150;  ///< cones: the nearest to the car

// The fit, in units of a cone's noise.
constexpr double kConeNoise_m = 0.15;
constexpr std::array<double, 6> kWindows_m = {1.0, 0.8, 0.6, 0.45, 0.45, 0.45};

double square(double value) {
    return value * value;
}

Point rotated(const Point& vector, double angle_rad) {
    const double c = std::cos(angle_rad);
    const double s = std::sin(angle_rad);
    return {c * vector.x() - s * vector.y(), s * vector.x() + c * vector.y()};
}

std::vector<SeenCone> nearest_to(const Point& car, std::span<const SeenCone> cones, std::size_t count) {
    std::vector<SeenCone> nearest(cones.begin(), cones.end());
    if (nearest.size() > count) {
        std::ranges::stable_sort(nearest, {},
                                 [&](const SeenCone& cone) { return (cone.position - car).squaredNorm(); });
        nearest.resize(count);
    }
    return nearest;
}

/// The candidates of the highest scores. One stands for its neighbourhood: the best.
class BestCandidates {
  public:
    explicit BestCandidates(const Point& car) : car_(car) {}

    [[nodiscard]] bool takes(double score) const {
        return best_.size() < kMaxCandidates || score > best_.back().score;
    }
    void add(const RegistrationFit& candidate) {
        const auto place = std::ranges::find_if(
            best_, [&](const RegistrationFit& other) { return candidate.score > other.score; });
        const auto near = [&](const RegistrationFit& other) {
            const Registration& a = candidate.registration;
            const Registration& b = other.registration;
            return std::abs(a.course.yaw_rad - b.course.yaw_rad) < 2.5 * kStep_rad &&
                   (a.to_course(car_) - b.to_course(car_)).norm() < 2.5 * kStep_m;
        };
        if (std::any_of(best_.begin(), place, near)) return;
        const auto from = best_.insert(place, candidate) + 1;
        best_.erase(std::remove_if(from, best_.end(), near), best_.end());
        if (best_.size() > kMaxCandidates) best_.pop_back();
    }
    [[nodiscard]] std::vector<RegistrationFit> take() { return std::move(best_); }

  private:
    Point car_;
    std::vector<RegistrationFit> best_;
};

/// The moves of the car along and across the course that a search tries.
std::vector<Point> moves_within(const SearchReach& reach, bool along) {
    const int aheads = along ? static_cast<int>(std::ceil(reach.ahead_m / kStep_m)) : 0;
    const int lefts = static_cast<int>(std::ceil(reach.left_m / kStep_m));
    std::vector<Point> moves;
    for (int ahead = -aheads; ahead <= aheads; ++ahead) {
        for (int left = -lefts; left <= lefts; ++left) moves.emplace_back(ahead * kStep_m, left * kStep_m);
    }
    return moves;
}

}  // namespace

bool SeenView::covers(const Point& place) const {
    const double ahead_m = pose.ahead_m(place);
    const double left_m = pose.left_m(place);
    const double distance_m = std::hypot(ahead_m, left_m);
    return distance_m > kBlind_m && distance_m < kSureShare * range_m &&
           std::abs(std::atan2(left_m, ahead_m)) < kSureShare * bearing_rad;
}

SeenView view_of(const Frame& frame) {
    SeenView view{frame.pose};
    double second_m = 0.0;
    for (const Cone& cone : frame.cones) {
        const double ahead_m = frame.pose.ahead_m(cone.position);
        const double left_m = frame.pose.left_m(cone.position);
        const double distance_m = std::hypot(ahead_m, left_m);
        second_m = std::max(second_m, std::min(view.range_m, distance_m));
        view.range_m = std::max(view.range_m, distance_m);
        view.bearing_rad = std::max(view.bearing_rad, std::abs(std::atan2(left_m, ahead_m)));
    }
    view.range_m = std::min(view.range_m, kMaxBeyond * second_m);
    return view;
}

void SeenCones::observe(const Frame& frame) {
    std::erase_if(cones_, [&](const SeenCone& cone) { return cone.last_s < frame.time_s - kForgotten_s; });
    for (const Cone& cone : frame.cones) {
        if (!((cone.position - frame.pose.position).norm() < kMaxDistance_m)) continue;
        SeenCone* same = nullptr;
        double nearest_m = kSameCone_m;
        for (SeenCone& seen : cones_) {
            const double distance_m = (seen.position - cone.position).norm();
            if (distance_m >= nearest_m) continue;
            nearest_m = distance_m;
            same = &seen;
        }
        if (same == nullptr) {
            if (cones_.size() < kMaxCones) cones_.push_back({cone.position, cone.color, 1, frame.time_s});
            continue;
        }
        same->sightings = std::min(same->sightings + 1, kAveragedSightings);
        same->position += (cone.position - same->position) / same->sightings;
        if (cone.color != ConeColor::unknown) same->color = cone.color;
        same->last_s = frame.time_s;
    }
}

Point Registration::to_course(const Point& in_map) const {
    return {course.ahead_m(in_map), course.left_m(in_map)};
}

Point Registration::to_map(const Point& in_course) const {
    return course.position + rotated(in_course, course.yaw_rad);
}

KnownRegistration::KnownRegistration(KnownCourse course) : course_(std::move(course)) {
    Point low(0.0, 0.0);
    Point high(0.0, 0.0);
    for (const KnownLine& line : course_.lines) {
        low = low.cwiseMin(Point(line.from_x_m, line.y_m));
        high = high.cwiseMax(Point(line.to_x_m, line.y_m));
    }
    for (const KnownArc& arc : course_.arcs) {
        const Point half(arc.radius_m, arc.radius_m);
        low = low.cwiseMin(arc.centre - half);
        high = high.cwiseMax(arc.centre + half);
    }
    const double margin_m = kMargin_m + course_.max_widening_m;
    raster_from_ = low - Point(margin_m, margin_m);
    columns_ = static_cast<int>(std::ceil((high.x() - low.x() + 2.0 * margin_m) / kCell_m));
    rows_ = static_cast<int>(std::ceil((high.y() - low.y() + 2.0 * margin_m) / kCell_m));
    constexpr double kWidthStep_m = 0.25;
    double widening_m = course_.min_widening_m;
    do {
        rasters_.push_back(raster(widening_m));
        widening_m += kWidthStep_m;
    } while (widening_m <= course_.max_widening_m);
}

KnownRegistration::Raster KnownRegistration::raster(double widening_m) const {
    Raster result{widening_m, std::vector<float>(static_cast<std::size_t>(columns_ * rows_))};
    for (int row = 0; row < rows_; ++row) {
        for (int column = 0; column < columns_; ++column) {
            const Point place = raster_from_ + kCell_m * Point(column + 0.5, row + 0.5);
            const auto contact = course_.boundary_at(place, widening_m, kNear_m);
            const double nearness = contact ? 1.0 - square(contact->off_m / kNear_m) : 0.0;
            const int cell = row * columns_ + column;
            result.nearness[static_cast<std::size_t>(cell)] = static_cast<float>(nearness);
        }
    }
    return result;
}

float KnownRegistration::nearness(const Raster& raster, std::span<const Point> in_cells,
                                  const Point& moved_cells) const {
    float sum = 0.0F;
    for (const Point& cone : in_cells) {
        const double x = cone.x() + moved_cells.x();
        const double y = cone.y() + moved_cells.y();
        if (x < 0.0 || y < 0.0 || x >= columns_ || y >= rows_) continue;
        const int cell = static_cast<int>(y) * columns_ + static_cast<int>(x);
        sum += raster.nearness[static_cast<std::size_t>(cell)];
    }
    return sum;
}

std::vector<RegistrationFit> KnownRegistration::candidates(std::span<const SeenCone> cones, const Pose& car,
                                                           const Pose& expected, const SearchReach& reach,
                                                           const Deadline& deadline) const {
    BestCandidates best(car.position);
    const std::vector<Point> moves = moves_within(reach, course_.has_place_along);
    std::vector<Point> in_cells(cones.size());  // the cones, by one heading of the car in the course
    const int yaws = static_cast<int>(std::ceil(reach.yaw_rad / kStep_rad));
    for (int yaw = -yaws; yaw <= yaws; ++yaw) {
        if (deadline.passed()) return {};
        const double heading_rad = expected.yaw_rad + yaw * kStep_rad;
        std::ranges::transform(cones, in_cells.begin(), [&](const SeenCone& cone) -> Point {
            return (rotated(cone.position - car.position, heading_rad - car.yaw_rad) + expected.position -
                    raster_from_) /
                   kCell_m;
        });
        const double yaw_rad = car.yaw_rad - heading_rad;
        for (const Point& moved : moves) {
            for (const Raster& raster : rasters_) {
                const double score = nearness(raster, in_cells, moved / kCell_m);
                if (!best.takes(score)) continue;
                const Point place = car.position - rotated(expected.position + moved, yaw_rad);
                best.add({.registration = {{place, yaw_rad}, raster.widening_m}, .score = score});
            }
        }
    }
    return best.take();
}

std::vector<RegistrationFit> KnownRegistration::contenders(std::span<const SeenCone> all,
                                                           std::span<const SeenView> views, const Pose& car,
                                                           const Pose& expected, const SearchReach& reach,
                                                           const Deadline& deadline) const {
    const std::vector<SeenCone> cones = nearest_to(car.position, all, kMaxSearched);
    if (cones.size() < static_cast<std::size_t>(kMinMatched)) return {};
    std::vector<RegistrationFit> found = candidates(cones, car, expected, reach, deadline);
    for (RegistrationFit& candidate : found) {
        if (deadline.passed()) return {};
        const Registration refined = refine(candidate.registration, cones, car.position);
        candidate = fit(refined, cones, views, car);
        // Of two that explain the cones equally well, the one nearer to what is expected.
        const Point off = refined.to_course(car.position) - expected.position;
        candidate.score -= 0.03 * off.squaredNorm();
    }
    std::ranges::stable_sort(found, std::greater{}, &RegistrationFit::score);
    if (found.empty() || found.front().score < kMinScore || found.front().matched < kMinMatched ||
        found.front().beside > found.front().matched) {
        return {};
    }
    const double least = found.front().score - std::max(kMinMargin, kMinMarginShare * found.front().score);
    const auto are_distinct = [&](const RegistrationFit& one, const RegistrationFit& other) {
        Point off = one.registration.to_course(car.position) - other.registration.to_course(car.position);
        if (!course_.has_place_along) off.x() = 0.0;
        const double turned_rad = std::remainder(
            one.registration.course.yaw_rad - other.registration.course.yaw_rad, 2.0 * std::numbers::pi);
        return off.norm() > kDistinct_m || std::abs(turned_rad) > kDistinct_rad;
    };
    std::vector<RegistrationFit> contenders;
    for (const RegistrationFit& fit : found) {
        if (fit.score <= least) break;
        const bool is_new = std::ranges::all_of(
            contenders, [&](const RegistrationFit& other) { return are_distinct(fit, other); });
        if (is_new) contenders.push_back(fit);
    }
    return contenders;
}

Registration KnownRegistration::refine(Registration registration, std::span<const SeenCone> all,
                                       const Point& car, const Stiffness& stiffness) const {
    const std::vector<SeenCone> cones = nearest_to(car, all, kMaxFitted);
    using Vector = Eigen::Vector4d;  // along x, along y, yaw about the car, widening
    const Vector prior(square(kConeNoise_m / stiffness.place_m), square(kConeNoise_m / stiffness.place_m),
                       square(kConeNoise_m / stiffness.yaw_rad), square(kConeNoise_m / stiffness.widening_m));
    Vector total = Vector::Zero();
    for (const double window_m : kWindows_m) {
        Eigen::Matrix4d normal = prior.asDiagonal();
        Vector right = -prior.cwiseProduct(total);
        const Point pivot = registration.to_course(car);
        for (const SeenCone& seen : cones) {
            const Point place = registration.to_course(seen.position);
            const Point arm = place - pivot;
            const auto contact = course_.boundary_at(place, registration.widening_m, window_m);
            if (!contact) continue;
            const double weight = square(1.0 - square(contact->off_m / window_m));
            const Point& across = contact->normal;
            const Vector row(across.x(), across.y(), arm.x() * across.y() - arm.y() * across.x(),
                             contact->outward);
            normal += weight * row * row.transpose();
            right += weight * contact->off_m * row;
        }
        const Vector step = normal.ldlt().solve(right);
        total += step;
        // The course moves and turns about the car.
        const double yaw_rad = registration.course.yaw_rad;
        registration.course.yaw_rad = yaw_rad + step[2];
        registration.course.position =
            car + rotated(Point(step[0], step[1]), yaw_rad) - rotated(pivot, registration.course.yaw_rad);
        registration.widening_m =
            std::clamp(registration.widening_m + step[3], course_.min_widening_m, course_.max_widening_m);
    }
    return registration;
}

RegistrationFit KnownRegistration::fit(const Registration& registration, std::span<const SeenCone> all,
                                       std::span<const SeenView> views, const Pose& car) const {
    const std::vector<SeenCone> cones = nearest_to(car.position, all, kMaxFitted);
    RegistrationFit result;
    result.registration = registration;
    std::vector<Point> on_boundary;
    for (const SeenCone& seen : cones) {
        const Point place = registration.to_course(seen.position);
        const auto contact = course_.boundary_at(place, registration.widening_m, kBeside_m);
        if (!contact) continue;
        if (std::abs(contact->off_m) >= kMatched_m) {
            ++result.beside;
            continue;
        }
        ++result.matched;
        on_boundary.push_back(seen.position);
        result.score += 1.0 - square(contact->off_m / kMatched_m);
        if (seen.color != ConeColor::unknown && contact->color != ConeColor::unknown) {
            if (seen.color == contact->color || (is_orange(seen.color) && is_orange(contact->color))) {
                result.score += kColor;
            } else if (!is_orange(seen.color) && !is_orange(contact->color)) {
                result.score -= kColor;
            }
        }
        if (car.ahead_m(seen.position) > 0.0) {
            result.farthest_m = std::max(result.farthest_m, (seen.position - car.position).norm());
        }
    }
    for (const KnownPlace& known : course_.places) {
        const Point place = registration.to_map(known.position + registration.widening_m * known.outward);
        const bool in_view =
            std::ranges::any_of(views, [&](const SeenView& view) { return view.covers(place); });
        if (!in_view) continue;
        ++result.places;
        if (std::ranges::any_of(on_boundary,
                                [&](const Point& cone) { return (cone - place).norm() < known.reach_m; })) {
            ++result.taken;
        }
        const bool is_there = std::ranges::any_of(
            cones, [&](const SeenCone& cone) { return (cone.position - place).norm() < known.reach_m; });
        if (!is_there) result.score -= kMissing;
    }
    return result;
}

}  // namespace conelane
