#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/progress/progress.hpp"
#include "experiments/cross_validation/cross_validation.hpp"
#include "experiments/race/drivers.hpp"
#include "experiments/race/race_record.hpp"
#include "program/commands/command_parts.hpp"

#include <exception>
#include <map>
#include <set>
#include <thread>

namespace conelane::program {
namespace {

constexpr int kTrackdriveLaps = 10;
constexpr double kDegree_rad = std::numbers::pi / 180.0;

struct Options {
    std::vector<std::string> tracks;
    std::vector<std::string> families;  ///< NAME=SPEC
    std::string folds;                  ///< folder with the weights of each family; empty: none
    std::string weights;                ///< file for all courses; empty: the shipped ones
    std::vector<std::string> detectors{"front"};
    bool planner = false;
    bool both = false;
    std::string mission;
    std::string condition = "car";
    std::vector<double> rates{0.0};
    std::vector<std::uint64_t> seeds{1};
    bool vary = false;
    std::string ids = "tracked";
    std::string fault = "none";
    std::string replay = "unfinished";
    RaceOptions race;
    std::optional<int> laps;
    double fov_deg = 180.0;
    std::string speed = "6";
    std::string car = "kinematic";
    double latency_ms = 50.0;
    double start_deg = 0.0;
    double drift_deg = 0.0;
    unsigned threads = 1;
    std::string out;
    bool overwrite = false;
};

bool has_known_course(std::optional<Mission> mission) {
    return mission == Mission::acceleration || mission == Mission::skidpad;
}

/// A course, and the folder of the fold that held it out; empty: none.
struct FoldedCourse {
    RaceCourse course;
    std::filesystem::path fold = {};
};

/// Measures what the same car needs for a first lap and a later one, if it knows its pose and the course.
void add_known_laps(const RaceCourse& course, const RaceOptions& as_raced, RaceResult& result) {
    const RaceOptions options{.sight = {},
                              .laps = 2,
                              .by_safe = true,
                              .with_slip = as_raced.with_slip,
                              .limits = as_raced.limits,
                              .latency_s = as_raced.latency_s};
    const RaceResult known = race(course, options, truth_driver(course, options.laps, 60.0));
    for (const std::size_t later : {0U, 1U}) result.by_lap[later].known_lap_s = known.by_lap[later].time_s;
}

void add_circuits(std::vector<FoldedCourse>& courses, const std::string& spec, std::optional<Mission> mission,
                  const std::filesystem::path& fold) {
    for (const Track& track : load_tracks_aloud(spec)) {
        if (!track.closed || !track.driven.empty()) {
            fmt::print(stderr, "conelane: {} is left out: not a closed course with boundaries\n", track.name);
            continue;
        }
        courses.push_back({circuit(track), fold});
        if (mission) courses.back().course.mission = *mission;
    }
}

/// With --vary, one course for each seed, in the order of the seeds.
std::vector<FoldedCourse> courses_of(const Options& options, std::optional<Mission> mission) {
    std::vector<FoldedCourse> courses;
    if (has_known_course(mission)) {
        if (!options.families.empty()) throw InvalidInput("--family", "is for circuits");
        if (options.vary) {
            if (!options.tracks.empty()) {
                throw InvalidInput("--vary", "is for the courses that missions have of their own");
            }
            for (const std::uint64_t seed : options.seeds) {
                courses.push_back({varied_mission_course(*mission, seed)});
            }
            return courses;
        }
        if (options.tracks.empty()) courses.push_back({mission_course(*mission)});
        for (const std::string& spec : options.tracks) {
            for (const Track& track : load_tracks_aloud(spec)) {
                if (track.closed) {
                    throw InvalidInput("--tracks", fmt::format("'{}' is a circuit, no course of {}",
                                                               track.name, options.mission));
                }
                courses.push_back({mission_course(*mission, track)});
            }
        }
        return courses;
    }
    if (options.vary) throw InvalidInput("--vary", "is for the missions acceleration and skidpad");
    if (options.tracks.empty() && options.families.empty())
        throw InvalidInput("--tracks", "is required, except in acceleration and skidpad");
    for (const std::string& spec : options.tracks) add_circuits(courses, spec, mission, {});
    for (const CourseFamily& family : parse_families(options.families)) {
        std::filesystem::path fold;
        if (!options.folds.empty()) fold = std::filesystem::path(options.folds) / family.name;
        std::set<std::string> held_out;
        for (const std::string& spec : family.tracks) {
            add_circuits(courses, spec, mission, fold);
            if (fold.empty()) continue;
            for (const Track& track : load_tracks(spec)) held_out.insert(track.name);
        }
        if (!fold.empty()) require_held_out(held_out, fold);
    }
    if (courses.empty()) throw InvalidInput("--tracks", "hold no closed course with boundaries");
    return courses;
}

/// The weights of methods, each file read once.
class RacersWeights {
  public:
    explicit RacersWeights(std::filesystem::path file_for_all) : file_for_all_(std::move(file_for_all)) {}

    /// Null: the shipped weights, or none.
    const WeightsBytes* of(const Racer& racer, const std::filesystem::path& fold) {
        if (!racer.takes_weights() || (file_for_all_.empty() && fold.empty())) return nullptr;
        const std::filesystem::path file =
            fold.empty() ? file_for_all_ : fold / racer.method->weights_file_of_fold();
        const auto [known, is_new] = weights_.try_emplace({file, racer.method->name});
        if (is_new) {
            known->second = read_weights_bytes(file, "'" + racer.method->name + "'", racer.method->recipe);
        }
        return &known->second;
    }

  private:
    std::filesystem::path file_for_all_;
    std::map<std::pair<std::filesystem::path, std::string>, WeightsBytes> weights_;
};

/// A race and its input.
struct Entry {
    const RaceCourse* course;
    const Racer* racer;
    const WeightsBytes* weights;  ///< null: the shipped ones
};

void run_all(const Options& options, const std::vector<Entry>& entries, std::vector<Heat>& heats) {
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::exception_ptr failure;
    Progress progress("races", heats.size());
    const auto work = [&] {
        try {
            for (std::size_t i = next++; i < heats.size(); i = next++) {
                Heat& heat = heats[i];
                RaceOptions race_options = options.race;
                race_options.sight.false_positive_rate = heat.false_positive_rate;
                race_options.sight.seed = heat.seed;
                race_options.keep_replay = options.replay != "none";
                const auto& [raced, racer, weights] = entries[i];
                const RaceCourse& course = *raced;
                race_options.with_any_map = !course.closed && heat.detector != "truth";
                heat.result = race(course, race_options, make_driver(*racer, course, race_options, weights));
                if (race_options.by_safe) add_known_laps(course, race_options, heat.result);
                // Keeps only the races that failed, and the first one, so that there is one to look at.
                if (options.replay == "unfinished" && heat.result.finished() && i > 0) {
                    heat.result.replay.clear();
                }
                progress.advance();
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

nlohmann::ordered_json parameters_of(const Options& options, const std::vector<Racer>& racers) {
    std::vector<std::string> names;
    for (const Racer& racer : racers) names.push_back(racer.name);
    const Provenance origin = provenance();
    return {{"commit", origin.commit},
            {"compiler", origin.compiler},
            {"machine", origin.machine},
            {"tracks", options.tracks},
            {"families", options.families},
            {"folds", options.folds},
            {"weights", options.weights},
            {"methods", names},
            {"mission", options.mission},
            {"condition", options.condition},
            {"fp", options.rates},
            {"seeds", options.seeds},
            {"vary", options.vary},
            {"laps", options.race.laps},
            {"range_m", options.race.sight.range_m},
            {"fov_deg", options.fov_deg},
            {"speed_mps", options.race.by_safe ? nlohmann::ordered_json("safe")
                                               : nlohmann::ordered_json(options.race.speed_mps)},
            {"car", options.car},
            {"range_noise", options.race.sight.noise_by_range},
            {"pose_time_s", options.race.sight.pose_time_s},
            {"latency_ms", options.latency_ms},
            {"colors", options.race.sight.with_color},
            {"ids", options.ids},
            {"fault", options.fault},
            {"start_error_m", options.race.start_error_m},
            {"start_error_deg", options.start_deg},
            {"drift_m", options.race.drift_m},
            {"drift_deg", options.drift_deg}};
}

/// The files of a result. They are opened before the work, so that an error is found early, and get their
/// names when all are complete.
class Outputs {
  public:
    explicit Outputs(const std::filesystem::path& folder)
        : races_(folder / "race.json"),
          table_(folder / "table.txt"),
          replay_(folder / "replay.jsonl"),
          times_(folder / "times.txt") {}

    void write(const Options& options, const std::vector<Racer>& racers, const std::vector<Entry>& entries,
               const std::vector<Heat>& heats) {
        nlohmann::ordered_json json = parameters_of(options, racers);
        json["races"] = nlohmann::ordered_json::array();
        for (std::size_t i = 0; i < heats.size(); ++i) {
            json["races"].push_back(heat_json(heats[i]));
            if (heats[i].result.replay.empty()) continue;
            replay_.stream() << replay_json(heats[i], *entries[i].course).dump() << "\n";
        }
        std::string table = race_table(heats, options.race.laps);
        if (options.race.by_safe) table += "\n" + speed_table(heats);
        const std::string times = answer_time_table(heats);
        races_.stream() << json.dump(1) << "\n";
        table_.stream() << table;
        times_.stream() << times;
        AtomicFile* const files[] = {&races_, &table_, &replay_, &times_};
        commit_together(files);
        fmt::print("{}\n{}", table, times);
    }

  private:
    AtomicFile races_;
    AtomicFile table_;
    AtomicFile replay_;
    AtomicFile times_;
};

/// Throws InputError if the folder has a comparison, or without `overwrite` the files of an earlier race.
void make_folder(const std::filesystem::path& folder, bool overwrite) {
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure) throw InputError(folder, 0, "", "cannot be made: " + failure.message());
    if (std::filesystem::exists(folder / "run.json"))
        throw InputError(folder, 0, "", "holds a comparison; name another folder");
    for (const char* const file : {"race.json", "table.txt"}) {
        if (!overwrite && std::filesystem::exists(folder / file))
            throw InputError(folder, 0, "", fmt::format("holds {}; --overwrite replaces it", file));
    }
}

void run_races(Options& options) {
    SceneOptions scene_options;
    scene_options.conditions = {options.condition};
    scene_options.false_positive_rates = options.rates;
    scene_options.ranges_m = {options.race.sight.range_m};
    validate(scene_options);
    options.race.sight.condition = conditions_of(scene_options).front();
    options.race.sight.with_ids = options.ids == "tracked";
    options.race.fault = race_fault(options.fault);
    options.race.sight.fov_rad = options.fov_deg * kDegree_rad;
    options.race.by_safe = options.speed == "safe";
    options.race.with_slip = options.car == "dynamic";
    if (!options.race.by_safe) options.race.speed_mps = std::stod(options.speed);
    options.race.latency_s = options.latency_ms / 1000.0;
    options.race.start_error_rad = options.start_deg * kDegree_rad;
    options.race.drift_rad = options.drift_deg * kDegree_rad;
    std::optional<Mission> mission;
    if (!options.mission.empty()) mission = mission_named(options.mission);
    options.race.with_stop = mission.has_value();
    const bool is_trackdrive = mission == Mission::trackdrive;
    options.race.laps = options.laps.value_or(is_trackdrive ? kTrackdriveLaps : 1);
    if (mission && !is_trackdrive && options.race.laps != 1) {
        throw InvalidInput("--laps", "must be 1: that is what " + options.mission + " has");
    }
    for (const std::uint64_t seed : options.seeds) {
        if (std::ranges::count(options.seeds, seed) > 1) {
            throw InvalidInput("--seed", fmt::format("{} is there twice", seed));
        }
    }
    const std::vector<Racer> all = racers(options.detectors, options.both      ? WithPlanner::both
                                                             : options.planner ? WithPlanner::only
                                                                               : WithPlanner::no);
    const bool any_weights = !options.weights.empty() || !options.folds.empty();
    if (any_weights && std::ranges::none_of(all, &Racer::takes_weights)) {
        throw InvalidInput(options.weights.empty() ? "--folds" : "--weights",
                           "none of the methods takes weights: only front, front-warm and rld-strip do");
    }
    const std::vector<FoldedCourse> courses = courses_of(options, mission);
    RacersWeights weights(options.weights);
    std::vector<Heat> heats;
    std::vector<Entry> entries;
    const std::size_t distinct_courses = options.vary ? 1 : courses.size();
    for (std::size_t first = 0; first < distinct_courses; ++first) {
        for (const Racer& racer : all) {
            for (const double rate : options.rates) {
                for (std::size_t i = 0; i < options.seeds.size(); ++i) {
                    const auto& [course, fold] = courses[options.vary ? i : first];
                    heats.push_back({course.name, racer.name, rate, options.seeds[i]});
                    entries.push_back({&course, &racer, weights.of(racer, fold)});
                }
            }
        }
    }
    make_folder(options.out, options.overwrite);
    Outputs outputs(options.out);
    if (mission && std::ranges::any_of(all, [](const Racer& racer) { return racer.method.has_value(); }) &&
        std::ranges::none_of(all, &Racer::has_planner)) {
        fmt::print(stderr, "conelane: {}: only a planner says when to stop, use --planner\n",
                   options.mission);
    }
    run_all(options, entries, heats);
    outputs.write(options, all, entries, heats);
}

}  // namespace

void add_race_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("race", "drives a simulated car through an event by the answers of methods");
    auto options = std::make_shared<Options>();
    command.add_option("--tracks", options->tracks,
                       "closed courses, as for `scenes`. Acceleration and skidpad have a course by default");
    CLI::Option* const families = command.add_option(
        "--family", options->families, "NAME=SPEC: more courses, and the fold that held them out");
    command
        .add_option(
            "--folds", options->folds,
            "the weights for the courses of --family NAME are in FOLDER/NAME, as `cross-validate` leaves "
            "them in OUT/folds: front.json, rld-strip.json")
        ->needs(families);
    command
        .add_option("--weights", options->weights,
                    "weights of the methods that take them: a file that `conelane train` wrote")
        ->excludes("--folds");
    command
        .add_option(
            "--methods", options->detectors,
            "names of `conelane methods`; exec:NAME=COMMAND; truth: the true centre line; none: no path")
        ->capture_default_str();
    command.add_flag("--planner", options->planner, "each detector drives through a planner");
    command.add_flag("--both", options->both, "each detector drives alone and through a planner");
    add_word_option(command, "--mission", options->mission,
                    {"acceleration", "skidpad", "autocross", "trackdrive"},
                    "from a standstill to a stop: acceleration, skidpad, autocross or trackdrive; without it "
                    "the car rolls and the last lap ends the race");
    command.add_flag("--vary", options->vary,
                     "acceleration and skidpad: each seed draws another course within the rules");
    command.add_option("--condition", options->condition, "paper, car, harsh or slam")->capture_default_str();
    command.add_option("--fp", options->rates, "share of false positives")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option("--range", options->race.sight.range_m, "radius of the visible half disc [m]")
        ->capture_default_str();
    command.add_option("--laps", options->laps, "laps of a race; default 1, in a trackdrive 10")
        ->check(CLI::Range(1, 1000));
    add_number_option(command, "--fov", options->fov_deg, 20.0, 180.0,
                      "angle of view, in the middle ahead [degrees]");
    command
        .add_option("--speed", options->speed,
                    "speed of the car [m/s]; safe: as fast as the path and its trusted length allow")
        ->check((CLI::Range(0.5, 40.0) & !CLI::IsMember({"nan", "-nan"}, CLI::ignore_case)) |
                CLI::IsMember({"safe"}))
        ->capture_default_str();
    add_word_option(command, "--car", options->car, {"kinematic", "dynamic"},
                    "kinematic: it does not slip; dynamic: tyres slip and saturate, commands come late");
    add_number_option(command, "--range-noise", options->race.sight.noise_by_range, 0.0, 0.1,
                      "noise of a cone that is added for each metre of its distance [m]");
    add_number_option(command, "--pose-time-s", options->race.sight.pose_time_s, 0.0, 60.0,
                      "correlation time of the pose error [s]; 0: drawn in each frame");
    command.add_option("--seed", options->seeds, "seeds; each gives a race")
        ->delimiter(',')
        ->check(seed_number())
        ->capture_default_str();
    add_number_option(command, "--latency-ms", options->latency_ms, 0.0, 1000.0,
                      "simulated time from a frame to its path");
    command.add_flag("--colors", options->race.sight.with_color, "cones have their colour");
    add_word_option(command, "--ids", options->ids, {"tracked", "none"},
                    "tracked: points keep their id; none: no point has one");
    add_word_option(command, "--fault", options->fault,
                    {"none", "jump", "late", "twice", "order", "blackout", "ids"},
                    "jump: the map moves by 0.5 m; late, twice, order: frames come late, twice or out of "
                    "order; blackout: 1 s without cones; ids: all cones change their id");
    add_number_option(command, "--start-error", options->race.start_error_m, 0.0, 3.0,
                      "largest distance of the car from the start [m]");
    add_number_option(command, "--start-error-deg", options->start_deg, 0.0, 45.0,
                      "largest angle between the car and the start's direction [degrees]");
    add_number_option(command, "--drift", options->race.drift_m, 0.0, 10.0,
                      "how far the map moves in a lap [m]");
    add_number_option(command, "--drift-deg", options->drift_deg, 0.0, 45.0,
                      "how far the map turns in a lap [degrees]");
    add_word_option(command, "--replay", options->replay, {"unfinished", "all", "none"},
                    "races in replay.jsonl: unfinished (and the first one), all or none");
    add_threads_option(command, options->threads, "number of threads; the results do not depend on it");
    command.add_option("--out", options->out, "folder for race.json, table.txt, replay.jsonl and times.txt")
        ->required();
    command.add_flag("--overwrite", options->overwrite, "replace an earlier race in that folder");
    command.callback([options] { run_races(*options); });
}

}  // namespace conelane::program
