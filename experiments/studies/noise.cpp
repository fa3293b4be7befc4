#include "experiments/studies/noise.hpp"

#include "conelane/detectors.hpp"
#include "conelane/invalid_input.hpp"
#include "evaluation/world/half_disc.hpp"
#include "evaluation/world/scene_draws.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/text_table.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

void count(const LaneAnswer& answer, const NoiseOptions& options, NoiseRow& row) {
    constexpr double kFar_m = 10.0;
    if (answer.status == LaneStatus::error)
        throw std::runtime_error(fmt::format("{}: {}", row.detector, answer.message));
    if (answer.status != LaneStatus::found) return;
    ++row.found;
    if (answer.confidence) {
        row.max_confidence = std::max(row.max_confidence, *answer.confidence);
        if (*answer.confidence > options.confidence) ++row.claimed;
    } else {
        ++row.unrated;
    }
    row.mean_trusted_m += answer.trusted_m.value_or(0.0) / static_cast<double>(row.scenes);
    if (answer.trusted_m.value_or(0.0) >= kFar_m) ++row.trusted_10_m;
}

nlohmann::ordered_json row_to_json(const NoiseRow& row) {
    return {{"method", row.detector},
            {"range", row.range_m},
            {"scenes", row.scenes},
            {"found", row.found},
            {"unrated", row.unrated},
            {"claimed", row.claimed},
            {"max_confidence", row.max_confidence},
            {"mean_trusted_m", row.mean_trusted_m},
            {"trusted_10_m", row.trusted_10_m}};
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
        TextTable table({{"method", true},
                         {"range m"},
                         {"scenes"},
                         {"found %"},
                         {"unrated %"},
                         {"claimed %"},
                         {"max conf."},
                         {"trusted m"},
                         {"10 m %"}});
        for (const NoiseRow& row : rows) {
            table.add({row.detector, fmt::format("{:g}", row.range_m), std::to_string(row.scenes),
                       percent(share(row.found, row.scenes), 1), percent(share(row.unrated, row.scenes), 1),
                       percent(share(row.claimed, row.scenes), 1), fixed(row.max_confidence, 2),
                       fixed(row.mean_trusted_m, 2), percent(share(row.trusted_10_m, row.scenes), 1)});
        }
        return study_result(table.text(), rows, [](const NoiseRow& row) { return row_to_json(row); });
    }

  private:
    NoiseOptions options_;
};

}  // namespace

Scene noise_scene(const NoiseOptions& options, double range_m, std::size_t index) {
    const std::string id = fmt::format("noise/{}/range_{}/{:04}", options.cones, range_m, index);
    SceneGenerator random = generator_for(fmt::format("{}/{}", id, options.seed));
    boost::random::uniform_real_distribution<double> ahead_m(0.0, range_m);
    boost::random::uniform_real_distribution<double> left_m(-range_m, range_m);
    Scene scene;
    scene.id = id;
    const HalfDisc view{scene.pose.position, scene.pose.heading(), range_m};
    while (scene.cones.size() < options.cones) {
        const double ahead = ahead_m(random);
        const double left = left_m(random);
        Cone cone;
        cone.id = static_cast<ConeId>(scene.cones.size());
        cone.position = rounded(Point(ahead, left));
        if (view.contains(cone.position)) scene.cones.push_back(cone);
    }
    return scene;
}

std::vector<NoiseRow> noise_rows(const NoiseOptions& options) {
    for (const double range_m : options.ranges_m) {
        if (!(range_m > 0.0 && std::isfinite(range_m))) throw InvalidInput("--range", "must be above 0");
    }
    Progress progress("noise", options.detectors.size() * options.ranges_m.size() * options.scenes);
    std::vector<NoiseRow> rows;
    for (const std::string& name : options.detectors) {
        const std::unique_ptr<LaneDetector> detector = make_detector(name);
        for (const double range_m : options.ranges_m) {
            NoiseRow row{.detector = name, .range_m = range_m, .scenes = options.scenes};
            for (std::size_t index = 0; index < options.scenes; ++index) {
                detector->reset();
                const Scene scene = noise_scene(options, range_m, index);
                count(detector->detect(scene, {options.time_limit_ms}), options, row);
                progress.advance();
            }
            rows.push_back(std::move(row));
        }
    }
    return rows;
}

std::unique_ptr<Study> make_noise_study() {
    return std::make_unique<NoiseStudy>();
}

}  // namespace conelane::experiments
