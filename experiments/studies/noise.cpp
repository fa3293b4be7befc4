#include "experiments/studies/noise.hpp"

#include "conelane/detectors.hpp"
#include "evaluation/world/scene_draws.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/study.hpp"

#include <stdexcept>
#include <utility>

#include <CLI/CLI.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct NoiseOptions {
    std::vector<std::string> detectors{"front", "front-warm"};
    std::size_t cones = 16;                          ///< in each scene, all of them false
    std::vector<double> ranges_m{20.0, 30.0, 50.0};  ///< radius of the half disc that holds them
    std::size_t scenes = 1000;                       ///< for each range
    double confidence = 0.3;                         ///< a lane of a higher one is claimed
    double time_limit_ms = 1000.0;
    std::uint64_t seed = 1;
};

/// One answer.
struct NoiseRow {
    std::string detector;
    double range_m = 0.0;
    bool found = false;
    std::optional<double> confidence = {};  ///< of a lane
    bool claimed = false;                   ///< its confidence is above NoiseOptions::confidence
    double trusted_m = 0.0;                 ///< 0 where there is no lane

    [[nodiscard]] bool is_unrated() const { return found && !confidence; }
    [[nodiscard]] bool is_trusted_10_m() const { return trusted_m >= 10.0; }
};

RowFields<RowGroup<NoiseRow>> noise_fields() {
    using Row = NoiseRow;
    return {{"method", first_of(&Row::detector), Shown::text("method")},
            {"range", first_of(&Row::range_m), Shown::number("range m")},
            {"scenes", &RowGroup<Row>::size, Shown::number("scenes")},
            {"found", count_of(&Row::found)},
            {"", share_of(&Row::found), Shown::percent("found %", 1)},
            {"unrated", count_of(&Row::is_unrated)},
            {"", share_of(&Row::is_unrated), Shown::percent("unrated %", 1)},
            {"claimed", count_of(&Row::claimed)},
            {"", share_of(&Row::claimed), Shown::percent("claimed %", 1)},
            {"max_confidence",
             [](const RowGroup<Row>& group) {
                 return group.sample(&Row::confidence).quantile(1.0).value_or(0.0);
             },
             Shown::fixed("max conf.", 2)},
            {"mean_trusted_m", mean_of(&Row::trusted_m), Shown::fixed("trusted m", 2)},
            {"trusted_10_m", count_of(&Row::is_trusted_10_m)},
            {"", share_of(&Row::is_trusted_10_m), Shown::percent("10 m %", 1)}};
}

/// Detectors in their order, each with the ranges in theirs. Every scene is one of its own: detectors that
/// remember their last lane forget it. Throws InvalidInput where a detector is unknown, and
/// std::runtime_error where an answer has status error.
std::vector<NoiseRow> noise_rows(const NoiseOptions& options) {
    Progress progress("noise", options.detectors.size() * options.ranges_m.size() * options.scenes);
    std::vector<NoiseRow> rows;
    for (const std::string& name : options.detectors) {
        const std::unique_ptr<LaneDetector> detector = make_detector(name);
        for (const double range_m : options.ranges_m) {
            for (std::size_t index = 0; index < options.scenes; ++index) {
                detector->reset();
                const Scene scene = noise_scene(options.cones, range_m, index, options.seed);
                const LaneAnswer answer = detector->detect(scene, {options.time_limit_ms});
                progress.advance();
                if (answer.status == LaneStatus::error)
                    throw std::runtime_error(fmt::format("{}: {}", name, answer.message));
                NoiseRow& row = rows.emplace_back(NoiseRow{name, range_m});
                if (answer.status != LaneStatus::found) continue;
                row.found = true;
                row.confidence = answer.confidence;
                row.claimed = answer.confidence.value_or(0.0) > options.confidence;
                row.trusted_m = answer.trusted_m.value_or(0.0);
            }
        }
    }
    return rows;
}

class NoiseStudy : public Study {
  public:
    NoiseStudy()
        : Study(
              {"noise", "how often is a lane claimed among false cones alone?",
               "Scenes without a course: false cones, uniform in the half disc ahead of the car. Claimed: "
               "the share of all scenes with a lane whose confidence is above --confidence. Unrated: with a "
               "lane that has no confidence, such as a boundary alone."}) {}

    void add_options(CLI::App& command) override {
        command.add_option("--methods", options_.detectors, "methods")->delimiter(',')->capture_default_str();
        command.add_option("--cones", options_.cones, "false cones in each scene")
            ->check(whole_number(1, 1000))
            ->capture_default_str();
        command.add_option("--range", options_.ranges_m, "radius of the half disc [m]")
            ->delimiter(',')
            ->check(CLI::Range(0.1, 1000.0))
            ->capture_default_str();
        command.add_option("--scenes", options_.scenes, "number of scenes for each range")
            ->check(whole_number(1, 1'000'000))
            ->capture_default_str();
        command.add_option("--confidence", options_.confidence, "a lane is claimed above it")
            ->check(CLI::Range(0.0, 1.0))
            ->capture_default_str();
        add_time_limit_option(command, options_.time_limit_ms);
        command.add_option("--seed", options_.seed, "of the scenes")->capture_default_str();
    }

    StudyResult run() override {
        const std::vector<NoiseRow> rows = noise_rows(options_);
        const auto key_of = [](const NoiseRow& row) { return std::pair(row.detector, row.range_m); };
        return study_result(groups_of<NoiseRow>(rows, key_of), noise_fields());
    }

  private:
    NoiseOptions options_;
};

}  // namespace

Scene noise_scene(std::size_t cones, double range_m, std::size_t index, std::uint64_t seed) {
    const std::string id = fmt::format("noise/{}/range_{}/{:04}", cones, range_m, index);
    SceneGenerator random = generator_for(fmt::format("{}/{}", id, seed));
    boost::random::uniform_real_distribution<double> ahead_m(0.0, range_m);
    boost::random::uniform_real_distribution<double> left_m(-range_m, range_m);
    Scene scene;
    scene.id = id;
    const HalfDisc view{scene.pose.position, scene.pose.heading(), range_m};
    while (scene.cones.size() < cones) {
        const double ahead = ahead_m(random);
        const double left = left_m(random);
        Cone cone;
        cone.id = static_cast<ConeId>(scene.cones.size());
        cone.position = rounded(Point(ahead, left));
        if (view.contains(cone.position)) scene.cones.push_back(cone);
    }
    return scene;
}

std::unique_ptr<Study> make_noise_study() {
    return std::make_unique<NoiseStudy>();
}

}  // namespace conelane::experiments
