#include "conelane/detectors.hpp"
#include "conelane/invalid_input.hpp"
#include "evaluation/files/atomic_file.hpp"
#include "evaluation/files/provenance.hpp"
#include "evaluation/scenes/scene_generation.hpp"
#include "evaluation/tracks/track_spec.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/race/race.hpp"
#include "experiments/studies/text_table.hpp"
#include "program/commands/commands.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

/// A path is due in 100 ms; the limit is so wide that no wall clock decides what is answered.
constexpr double kNoLimit_ms = 10'000.0;

struct Options {
    std::vector<std::string> tracks;
    std::vector<std::string> methods{"front"};
    std::string condition = "car";
    std::vector<double> rates{0.0};
    std::vector<std::uint64_t> seeds{1};
    RaceOptions race;
    double latency_ms = 50.0;
    unsigned threads = 1;
    std::string out;
};

struct Heat {
    const Track* track;
    std::string method;
    double rate;
    std::uint64_t seed;
    RaceResult result = {};
};

Entrant detector_entrant(const std::string& name) {
    return [detector = std::shared_ptr<LaneDetector>(make_detector(find_method(name)))](
               const Frame& frame) -> std::optional<std::vector<Point>> {
        const Scene scene{"race", frame.pose, frame.cones};
        const LaneAnswer answer = detector->detect(scene, {.time_limit_ms = kNoLimit_ms});
        if (answer.status != LaneStatus::found) return std::nullopt;
        std::vector<Point> path;
        for (const DrivablePoint& point : drivable(answer, scene).points) path.push_back(point.position);
        return path;
    };
}

Entrant entrant_of(const std::string& method, const Track& track) {
    return method == "truth" ? truth_entrant(track) : detector_entrant(method);
}

std::optional<double> median(std::vector<double> values) {
    if (values.empty()) return std::nullopt;
    std::ranges::sort(values);
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2.0;
}

std::string table_of(const Options& options, const std::vector<Heat>& heats) {
    TextTable table({{"method", true},
                     {"fp"},
                     {"races"},
                     {"finished %"},
                     {"laps %"},
                     {"departure m"},
                     {"cones/lap"},
                     {"error p95 m"},
                     {"no path %"},
                     {"old path s"},
                     {"unsteady %"}});
    for (const std::string& method : options.methods) {
        for (const double rate : options.rates) {
            std::size_t races = 0;
            std::size_t finished = 0;
            std::size_t laps = 0;
            std::size_t frames = 0;
            std::size_t without = 0;
            double hit = 0.0;
            double old_s = 0.0;
            std::vector<double> departures_m;
            std::vector<double> errors_m;
            double unsteady = 0.0;
            std::size_t with_pairs = 0;
            for (const Heat& heat : heats) {
                if (heat.method != method || heat.rate != rate) continue;
                const RaceResult& result = heat.result;
                ++races;
                finished += result.finished ? 1 : 0;
                laps += static_cast<std::size_t>(result.finished_laps);
                frames += static_cast<std::size_t>(result.frames);
                without += static_cast<std::size_t>(result.frames_without_path);
                // The lap in which a race ended counts as one.
                hit += result.cones_hit / static_cast<double>(result.finished_laps + !result.finished);
                old_s += result.old_path_s;
                if (result.departure_m) departures_m.push_back(*result.departure_m);
                if (result.lateral_error_p95_m) errors_m.push_back(*result.lateral_error_p95_m);
                if (result.unsteady_share) {
                    unsteady += *result.unsteady_share;
                    ++with_pairs;
                }
            }
            const auto count = static_cast<double>(races);
            table.add({method, fmt::format("{}", rate), std::to_string(races),
                       percent(share(finished, races), 1),
                       percent(share(laps, races * static_cast<std::size_t>(options.race.laps)), 1),
                       fixed(median(departures_m), 0), fixed(hit / count, 2), fixed(median(errors_m), 2),
                       percent(share(without, frames), 2), fixed(old_s / count, 2),
                       with_pairs == 0 ? "-" : percent(unsteady / static_cast<double>(with_pairs), 1)});
        }
    }
    return table.text();
}

nlohmann::ordered_json record_of(const Options& options, const Heat& heat) {
    const auto maybe = [](const std::optional<double>& value) {
        return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
    };
    const RaceResult& r = heat.result;
    return {{"track", heat.track->name},
            {"method", heat.method},
            {"condition", options.condition},
            {"false_positive_rate", heat.rate},
            {"seed", heat.seed},
            {"laps", options.race.laps},
            {"range_m", options.race.range_m},
            {"speed_mps", options.race.speed_mps},
            {"latency_ms", options.latency_ms},
            {"finished", r.finished},
            {"finished_laps", r.finished_laps},
            {"driven_m", r.driven_m},
            {"departure_m", maybe(r.departure_m)},
            {"cones_hit", r.cones_hit},
            {"lateral_error_p95_m", maybe(r.lateral_error_p95_m)},
            {"frames", r.frames},
            {"frames_without_path", r.frames_without_path},
            {"old_path_s", r.old_path_s},
            {"unsteady_share", maybe(r.unsteady_share)}};
}

void write(const std::filesystem::path& file, const std::string& text) {
    AtomicFile atomic(file);
    atomic.stream() << text;
    atomic.commit();
}

void run_all(const Options& options, std::vector<Heat>& heats) {
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::exception_ptr failure;
    const auto work = [&] {
        try {
            for (std::size_t i = next++; i < heats.size(); i = next++) {
                Heat& heat = heats[i];
                RaceOptions race_options = options.race;
                race_options.false_positive_rate = heat.rate;
                race_options.seed = heat.seed;
                heat.result = race(*heat.track, race_options, entrant_of(heat.method, *heat.track));
            }
        } catch (...) {
            const std::scoped_lock lock(mutex);
            failure = std::current_exception();
            next = heats.size();
        }
    };
    std::vector<std::jthread> threads;
    for (unsigned i = 1; i < options.threads; ++i) threads.emplace_back(work);
    work();
    threads.clear();
    if (failure) std::rethrow_exception(failure);
}

void run_races(Options& options) {
    SceneOptions scene_options;
    scene_options.conditions = {options.condition};
    scene_options.false_positive_rates = options.rates;
    scene_options.ranges_m = {options.race.range_m};
    validate(scene_options);
    options.race.condition = conditions_of(scene_options).front();
    options.race.latency_s = options.latency_ms / 1000.0;
    for (const std::string& method : options.methods) {
        if (method != "truth") static_cast<void>(find_method(method));
    }
    std::vector<Track> tracks;
    for (const std::string& spec : options.tracks) {
        for (Track& track : load_tracks(spec)) {
            if (!track.closed || !track.driven.empty()) {
                fmt::print(stderr, "conelane: {} is no closed course with boundaries: left out\n",
                           track.name);
                continue;
            }
            tracks.push_back(std::move(track));
        }
    }
    if (tracks.empty()) throw InvalidInput("--tracks", "hold no closed course with boundaries");
    std::vector<Heat> heats;
    for (const Track& track : tracks) {
        for (const std::string& method : options.methods) {
            for (const double rate : options.rates) {
                for (const std::uint64_t seed : options.seeds) heats.push_back({&track, method, rate, seed});
            }
        }
    }
    std::filesystem::create_directories(options.out);
    run_all(options, heats);
    std::string lines;
    for (const Heat& heat : heats) lines += record_of(options, heat).dump() + "\n";
    const std::string table = table_of(options, heats);
    const Provenance origin = provenance();
    const nlohmann::ordered_json run{{"commit", origin.commit},
                                     {"compiler", origin.compiler},
                                     {"machine", origin.machine},
                                     {"tracks", options.tracks},
                                     {"methods", options.methods},
                                     {"condition", options.condition},
                                     {"fp", options.rates},
                                     {"seeds", options.seeds},
                                     {"laps", options.race.laps},
                                     {"range_m", options.race.range_m},
                                     {"speed_mps", options.race.speed_mps},
                                     {"latency_ms", options.latency_ms}};
    const std::filesystem::path out = options.out;
    write(out / "run.json", run.dump(2) + "\n");
    write(out / "race.jsonl", lines);
    write(out / "table.txt", table);
    fmt::print("{}", table);
}

}  // namespace

void add_race_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("race", "drives closed courses by the answers of methods");
    auto options = std::make_shared<Options>();
    command.add_option("--tracks", options->tracks, "as of `scenes`; closed courses")->required();
    command
        .add_option("--methods", options->methods, "names as of `methods`, or truth: the true centre line")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option("--condition", options->condition, "paper, car or harsh")->capture_default_str();
    command.add_option("--fp", options->rates, "share of false positives")->delimiter(',');
    command.add_option("--range", options->race.range_m, "of sight [m]")->capture_default_str();
    command.add_option("--laps", options->race.laps, "of a race")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command.add_option("--speed", options->race.speed_mps, "[m/s]")
        ->check(CLI::Range(0.5, 40.0))
        ->capture_default_str();
    command.add_option("--seed", options->seeds, "a race for each")->delimiter(',');
    command.add_option("--latency-ms", options->latency_ms, "from a frame to its path, simulated")
        ->check(CLI::Range(0.0, 99.0))
        ->capture_default_str();
    add_threads_option(command, options->threads, "same results with any number");
    command.add_option("--out", options->out, "folder for race.jsonl, table.txt and run.json")->required();
    command.callback([options] { run_races(*options); });
}

}  // namespace conelane::experiments
