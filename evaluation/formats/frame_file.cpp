#include "evaluation/formats/frame_file.hpp"

#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/formats/track_spec.hpp"

#include <iterator>

#include <fmt/core.h>

namespace conelane {
namespace {

constexpr double kPathStep_m = 0.5;         ///< a car at rest adds no places
constexpr double kMaxConeDistance_m = 6.5;  ///< from the path: the width of the widest lane
constexpr double kSamePass_m = 8.0;         ///< of travel
constexpr double kMinLap_m = 30.0;          ///< travel before the path may be back at its start
constexpr double kBackAtStart_m = 3.0;      ///< from the start
constexpr double kBeyondPath_m = 15.0;      ///< straight extension behind the end of the path
constexpr double kEndDirection_m = 2.0;     ///< the extension has the direction of the last metres
constexpr std::size_t kMinConesOfALap = 3;

struct DrivenLap {
    std::vector<Point> path;  ///< places kPathStep_m apart at least
    bool closed = false;
};

/// The path up to its return to the start. If it does not return, the whole path with a straight extension.
DrivenLap first_lap(std::span<const Point> path) {
    DrivenLap lap;
    for (const Point& place : path) {
        if (lap.path.empty() || (place - lap.path.back()).norm() >= kPathStep_m) lap.path.push_back(place);
    }
    if (lap.path.size() < 2) return lap;
    const Point start_direction = lap.path[1] - lap.path[0];
    double travelled_m = 0.0;
    std::optional<std::size_t> back;  ///< the place nearest to the start while the path is near it
    for (std::size_t i = 1; i < lap.path.size(); ++i) {
        const Point along = lap.path[i] - lap.path[i - 1];
        travelled_m += along.norm();
        const double away_m = (lap.path[i] - lap.path[0]).norm();
        if (travelled_m < kMinLap_m || away_m > kBackAtStart_m || along.dot(start_direction) <= 0.0) {
            if (back) break;
        } else if (!back || away_m < (lap.path[*back] - lap.path[0]).norm()) {
            back = i;
        }
    }
    if (back) {
        lap.path.resize(*back);
        lap.closed = true;
    } else {
        const Point end = lap.path.back();
        const auto before = std::find_if(lap.path.rbegin(), lap.path.rend(), [&](const Point& place) {
            return (place - end).norm() >= kEndDirection_m;
        });
        const Point along = end - (before == lap.path.rend() ? lap.path.front() : *before);
        lap.path.emplace_back(end + kBeyondPath_m * along.normalized());
    }
    return lap;
}

std::vector<Segment> segments(std::span<const Point> polyline, bool closed) {
    std::vector<Segment> result;
    for (std::size_t i = 0; i + 1 < polyline.size(); ++i) result.push_back({polyline[i], polyline[i + 1]});
    if (closed) result.push_back({polyline.back(), polyline.front()});
    return result;
}

bool any_cross(std::span<const Segment> some, std::span<const Segment> others) {
    return std::ranges::any_of(some, [&](const Segment& a) {
        return std::ranges::any_of(others, [&](const Segment& b) { return segments_cross(a, b); });
    });
}

/// A cone beside the path: arc length, side and distance.
struct PassedCone {
    std::size_t cone;
    double along_m;
    bool left;
    double off_m;
};

/// The places where the car passes a cone, each the nearest to it for kSamePass_m; with `by_color` on the
/// side of the cone's color. None if the cone is too far away, behind the start or, with `by_color`, of
/// unknown color.
std::vector<PassedCone> passes_of(const Track& run, std::size_t cone, std::span<const Segment> path,
                                  bool closed, bool by_color) {
    const ConeColor color = run.cones[cone].color;
    if (by_color && color == ConeColor::unknown) return {};
    const Point& position = run.cones[cone].position;
    std::vector<PassedCone> passes;
    double before_m = 0.0;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const Point along = path[i].to - path[i].from;
        const Point off = position - path[i].from;
        const bool left = cross(along, off) > 0.0;
        const double length_m = along.norm();
        const double ahead_m = along.dot(off) / length_m;
        const bool beyond_ends =
            !closed && ((i == 0 && ahead_m < 0.0) || (i + 1 == path.size() && ahead_m > length_m));
        const double on_segment_m = std::clamp(ahead_m, 0.0, length_m);
        const PassedCone here{cone, before_m + on_segment_m, left,
                              (off - on_segment_m / length_m * along).norm()};
        before_m += length_m;
        const bool own_side = !by_color || is_orange(color) || left == (color == ConeColor::blue);
        if (!own_side || beyond_ends || here.off_m > kMaxConeDistance_m) continue;
        if (passes.empty() || here.along_m - passes.back().along_m > kSamePass_m) {
            passes.push_back(here);
        } else if (here.off_m < passes.back().off_m) {
            passes.back() = here;
        }
    }
    return passes;
}

constexpr std::size_t kConfirmingFrames = 5;  ///< in which a cone of a boundary without colors is seen
constexpr double kNextToPath_m = 0.8;         ///< the car would hit a cone that is nearer

/// The cones of one side, in the order in which the car passes them, that stay most evenly beside the path: a
/// shortest way from its start to its end. A step costs kChange of the square of how much the distance to the
/// path changes; kGap of the square of its length, so that no cone of the boundary is left out; and kAside of
/// the square of the distance for each metre, so that nearer cones are preferred to those of another lane.
std::vector<PassedCone> evenly_beside(const std::vector<PassedCone>& cones, double length_m) {
    constexpr double kChange = 2.0;
    constexpr double kGap = 0.15;
    constexpr double kAside = 0.05;
    std::vector<double> cost(cones.size());
    std::vector<std::size_t> before(cones.size());
    std::size_t last = cones.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < cones.size(); ++i) {
        const double aside = kAside * cones[i].off_m * cones[i].off_m;
        const auto way_cost = [&](double gap_m) { return (kGap * gap_m + aside) * gap_m; };
        cost[i] = way_cost(cones[i].along_m);
        before[i] = i;
        for (std::size_t j = 0; j < i; ++j) {
            const double change_m = cones[i].off_m - cones[j].off_m;
            const double whole =
                cost[j] + kChange * change_m * change_m + way_cost(cones[i].along_m - cones[j].along_m);
            if (whole < cost[i]) cost[i] = whole, before[i] = j;
        }
        const double whole = cost[i] + way_cost(length_m - cones[i].along_m);
        if (whole < least) least = whole, last = i;
    }
    std::vector<PassedCone> chain;
    for (std::size_t i = last; i < cones.size(); i = before[i]) {
        chain.push_back(cones[i]);
        if (before[i] == i) break;
    }
    std::ranges::reverse(chain);
    return chain;
}

/// The cones that the car passes, in that order: colored ones of the last map, else those of either side
/// among what enough frames have seen.
std::vector<PassedCone> cones_beside(const Track& run, std::span<const Segment> driven, bool closed,
                                     bool by_color) {
    std::vector<std::size_t> seen(run.cones.size(), 0);
    for (const RunFrame& frame : run.frames) {
        for (const MapPlace& place : frame.map) ++seen[place.cone];
    }
    std::vector<std::size_t> candidates;
    if (by_color) {
        for (const MapPlace& place : run.frames.back().map) candidates.push_back(place.cone);
    } else {
        for (std::size_t cone = 0; cone < seen.size(); ++cone) {
            if (seen[cone] >= kConfirmingFrames) candidates.push_back(cone);
        }
    }
    std::vector<PassedCone> all;
    for (const std::size_t candidate : candidates) {
        std::vector<PassedCone> passes = passes_of(run, candidate, driven, closed, by_color);
        const auto nearest = std::ranges::min_element(passes, {}, &PassedCone::off_m);
        if (nearest == passes.end()) continue;
        if (by_color)
            all.push_back(*nearest);
        else if (nearest->off_m >= kNextToPath_m)
            all.insert(all.end(), passes.begin(), passes.end());  // lanes may lie side by side
    }
    std::ranges::sort(all, {}, [](const PassedCone& cone) { return std::pair(cone.along_m, cone.cone); });
    return all;
}

/// Sets `left`, `right` and `closed` of a run by cones along the driven path: the colored ones of its last
/// map, or whatever stays evenly beside the path. If they do not bound a lane, it returns false and the track
/// stays unchanged.
bool set_boundaries_along(std::span<const Point> path, Track& run, bool by_color) {
    const DrivenLap lap = first_lap(path);
    if (lap.path.size() < 2) return false;
    const std::vector<Segment> driven = segments(lap.path, lap.closed);
    if (any_cross(driven, driven)) return false;

    const std::vector<PassedCone> all = cones_beside(run, driven, lap.closed, by_color);
    Track bounded;
    bounded.cones = run.cones;
    bounded.closed = lap.closed;
    for (const bool is_left : {true, false}) {
        std::vector<PassedCone> side;
        std::ranges::copy_if(all, std::back_inserter(side),
                             [&](const PassedCone& cone) { return cone.left == is_left; });
        if (!by_color) side = evenly_beside(side, polyline_length_m(lap.path, lap.closed));
        for (const PassedCone& cone : side) (is_left ? bounded.left : bounded.right).push_back(cone.cone);
    }
    const std::size_t fewest = lap.closed ? kMinConesOfALap : 2;
    if (bounded.left.size() < fewest || bounded.right.size() < fewest) return false;
    const TrackBoundaries lines = boundaries(bounded);
    const std::vector<Segment> left = segments(lines.left, lap.closed);
    const std::vector<Segment> right = segments(lines.right, lap.closed);
    if (any_cross(left, left) || any_cross(right, right) || any_cross(left, right)) return false;
    run.left = std::move(bounded.left);
    run.right = std::move(bounded.right);
    run.closed = lap.closed;
    return true;
}

constexpr double kSameCone_m = 0.8;  ///< in two frames
constexpr double kRunOver_m = 0.5;   ///< from the middle of the car

/// The colors of the five lists of a map.
constexpr std::array kListColors{ConeColor::unknown, ConeColor::yellow, ConeColor::blue, ConeColor::orange,
                                 ConeColor::orange};

Point read_point(const JsonNode& json) {
    if (json.array_size() != 2) json.fail("must be [x, y]");
    const auto coordinate = [&](std::size_t axis) {
        const double value = json.element(axis).number();
        if (const std::string fault = coordinate_fault(value); !fault.empty()) json.element(axis).fail(fault);
        return value;
    };
    return {coordinate(0), coordinate(1)};
}

std::vector<Cone> read_map(const JsonNode& json) {
    if (json.array_size() != kListColors.size()) json.fail("must hold five lists");
    std::vector<Cone> cones;
    for (std::size_t list = 0; list < kListColors.size(); ++list) {
        const JsonNode points = json.element(list);
        const std::size_t size = points.array_size();
        for (std::size_t i = 0; i < size; ++i) {
            cones.push_back({0, read_point(points.element(i)), kListColors[list], 1.0});
        }
    }
    return cones;
}

Pose read_pose(const JsonNode& frame) {
    const Point direction = read_point(frame.member("car_direction"));
    if (!(direction.norm() > 0.0)) frame.member("car_direction").fail("must not be [0, 0]");
    return {read_point(frame.member("car_position")), std::atan2(direction.y(), direction.x())};
}

/// Adds a map to the known cones. Each of its cones is a known one within kSameCone_m (nearest pairs first),
/// or a new one.
std::vector<MapPlace> recognise(const std::vector<Cone>& map, std::vector<Cone>& known) {
    std::vector<std::tuple<double, std::size_t, std::size_t>>
        pairs;  // distance, place in the map, known cone
    for (std::size_t i = 0; i < map.size(); ++i) {
        for (std::size_t j = 0; j < known.size(); ++j) {
            const double distance_m = (map[i].position - known[j].position).norm();
            if (distance_m <= kSameCone_m) pairs.emplace_back(distance_m, i, j);
        }
    }
    std::ranges::sort(pairs);
    constexpr auto kNone = static_cast<std::size_t>(-1);
    std::vector<std::size_t> known_of(map.size(), kNone);
    std::vector<bool> taken(known.size(), false);
    for (const auto& [distance_m, i, j] : pairs) {
        if (known_of[i] != kNone || taken[j]) continue;
        known_of[i] = j;
        taken[j] = true;
    }
    std::vector<MapPlace> places;
    for (std::size_t i = 0; i < map.size(); ++i) {
        if (known_of[i] == kNone) {
            known_of[i] = known.size();
            // Place and colour only: what else the recording says would show that a cone is no false
            // positive.
            known.push_back({.id = static_cast<ConeId>(known_of[i])});
        }
        known[known_of[i]].position = map[i].position;
        known[known_of[i]].color = map[i].color;
        places.push_back({known_of[i], map[i].position});
    }
    return places;
}

void add_frame(Track& run, const Pose& pose, const std::vector<Cone>& map) {
    RunFrame frame{pose, 0.0, recognise(map, run.cones)};
    if (!run.frames.empty()) {
        const RunFrame& before = run.frames.back();
        frame.travelled_m = before.travelled_m + (pose.position - before.pose.position).norm();
    }
    run.frames.push_back(std::move(frame));
}

std::vector<Point> path_of(const Track& run) {
    std::vector<Point> path;
    for (const RunFrame& frame : run.frames) path.push_back(frame.pose.position);
    return path;
}

/// Whether the car hits a cone of the map between two places.
bool runs_over_a_cone(const Track& run, const RunFrame& map, const Segment& way) {
    return std::ranges::any_of(map.map, [&](const MapPlace& place) {
        return foot_point(run.cones[place.cone].position, way).distance_m <= kRunOver_m;
    });
}

/// Sets the driven path and drops the frames after its end.
void set_driven_path(Track& run) {
    const RunFrame last_map = run.frames.back();
    std::size_t kept = 1;
    while (kept < run.frames.size() &&
           !runs_over_a_cone(run, last_map,
                             {run.frames[kept - 1].pose.position, run.frames[kept].pose.position})) {
        ++kept;
    }
    if (kept < run.frames.size()) {
        run.warnings.push_back(
            fmt::format("the car runs over a cone after {:.1f} m; {} frames from there on are left out",
                        run.frames[kept].travelled_m, run.frames.size() - kept));
    }
    run.frames.resize(kept);
    run.driven = path_of(run);
}

constexpr std::tuple kConeOfFrame =
    std::tuple_cat(std::tuple{Field{"id", &Cone::id, Absent::when_read}}, kSeenCone);

Frame read_own_frame(const JsonNode& json) {
    Frame frame;
    read_value(json.member("pose"), frame.pose);
    const JsonNode cones = json.member("cones");
    frame.cones.resize(cones.array_size(), Cone{.id = kNoId});
    for (std::size_t i = 0; i < frame.cones.size(); ++i)
        read_fields(cones.element(i), frame.cones[i], kConeOfFrame);
    return frame;
}

/// Reads frames one after another, each with its time.
class FrameReader {
  public:
    explicit FrameReader(double interval_s) : interval_s_(interval_s) {}

    FrameLine read(const JsonNode& json, std::size_t number) {
        FrameLine line{number, {}, false, {}};
        const auto reset = json.find("reset");
        line.reset = reset && reset->boolean();
        if (line.reset) {
            last_s_.reset();
            return line;
        }
        Frame frame = json.find("car_position") ? read_run_frame(json) : read_own_frame(json);
        frame.time_s = last_s_ ? *last_s_ + interval_s_ : 0.0;
        if (const auto time_s = json.find("time_s")) frame.time_s = time_s->number();
        last_s_ = frame.time_s;
        line.frame = std::move(frame);
        return line;
    }

  private:
    double interval_s_;
    std::optional<double> last_s_;
};

bool is_list(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && text[first] == '[';
}

}  // namespace

Track read_run_log(const std::filesystem::path& file) {
    Track run;
    run.name = "ftlog_" + file.stem().string();
    run.closed = false;
    with_json_list_file(file, [&](const JsonNode& list) {
        const std::size_t size = list.array_size();
        if (size == 0) list.fail("holds no frame");
        for (std::size_t i = 0; i < size; ++i) {
            const JsonNode frame = list.element(i);
            const Pose pose = read_pose(frame);
            add_frame(run, pose, read_map(frame.member("slam_cones")));
        }
    });
    if (run.cones.empty()) throw InputError(file, 0, "slam_cones", "no frame has a cone");

    const auto colored = [&](ConeColor color) {
        return std::ranges::count(run.cones, color, &Cone::color) >= 2;
    };
    if (colored(ConeColor::blue) && colored(ConeColor::yellow)) {
        if (set_boundaries_along(path_of(run), run, true)) return without_doubled_cones(std::move(run));
        run.warnings.emplace_back(
            "its coloured cones bound no lane along the driven path; the path alone counts");
    }
    set_driven_path(run);
    return run;
}

Track read_driven_run(const std::filesystem::path& file) {
    Track run;
    const std::string name = file.filename().string();
    run.name = "run_" + name.substr(0, name.find('.'));
    for (const FrameLine& line : read_frames(file, 0.1)) {
        if (line.reset && !run.frames.empty()) break;  // what follows is another run
        if (!line.frame) continue;
        std::vector<Point> places{line.frame->pose.position};
        for (const Cone& cone : line.frame->cones) places.push_back(cone.position);
        for (const Point& place : places) {
            for (const double coordinate_m : {place.x(), place.y()}) {
                if (const std::string fault = coordinate_fault(coordinate_m); !fault.empty())
                    throw InputError(file, line.number, "", "a coordinate " + fault);
            }
        }
        add_frame(run, line.frame->pose, line.frame->cones);
    }
    std::vector<Point> sums(run.cones.size(), Point(0.0, 0.0));
    std::vector<double> counts(run.cones.size(), 0.0);
    for (const RunFrame& frame : run.frames) {
        for (const MapPlace& place : frame.map) {
            sums[place.cone] += place.position;
            ++counts[place.cone];
        }
    }
    for (std::size_t cone = 0; cone < sums.size(); ++cone)
        run.cones[cone].position = sums[cone] / counts[cone];
    if (!set_boundaries_along(path_of(run), run, false))
        throw InputError(file, 0, "", "its cones bound no lane along the driven path");
    return without_doubled_cones(std::move(run));
}

Frame read_run_frame(const JsonNode& json) {
    Frame frame{0.0, read_pose(json), read_map(json.member("slam_cones"))};
    for (Cone& cone : frame.cones) cone.id = kNoId;
    return frame;
}

constexpr TrackFormat kRunTracks{
    .word = "ftlog",
    .what = "FILE",
    .reads = "a run of ft-fsd, JSON: a scene is the map that the car had in one frame",
    .ending = ".json",
    .read = read_run_log};
constexpr TrackFormat kDrivenRuns{
    .word = "run",
    .what = "FILE",
    .reads = "a run of your car, frames, labelled by the path that it drove; a scene is a frame",
    .ending = ".frames.jsonl",
    .read = read_driven_run};

std::vector<FrameLine> read_frames(const std::filesystem::path& file, double interval_s) {
    std::vector<FrameLine> lines;
    FrameReader reader(interval_s);
    bool any = false;
    const auto add = [&](const JsonNode& json, std::size_t number) {
        lines.push_back(reader.read(json, number));
        any = any || lines.back().frame;
    };
    if (is_list(text_of(file))) {
        with_json_list_file(file, [&](const JsonNode& list) {
            const std::size_t size = list.array_size();
            for (std::size_t i = 0; i < size; ++i) add(list.element(i), i + 1);
        });
    } else {
        for_each_json_line(file, [&](const JsonNode& json) { add(json, json.line()); });
    }
    if (!any) throw InputError(file, 0, "", "holds no frame");
    return lines;
}

void for_each_frame_line(std::istream& stream, double interval_s,
                         const std::function<void(const FrameLine&)>& use) {
    FrameReader reader(interval_s);
    const auto read = [&](const JsonNode& json, FrameLine& line) { line = reader.read(json, json.line()); };
    for_each_stream_line<FrameLine>(stream, read, use);
}

}  // namespace conelane
