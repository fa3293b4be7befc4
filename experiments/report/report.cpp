#include "experiments/report/report.hpp"

#include "conelane/drivable_lane.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/scoring/published_figures.hpp"
#include "evaluation/world/scene_options.hpp"
#include "experiments/report/package.hpp"

#include <span>
#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

namespace conelane {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PublishedClcRow, false_positive_rate, ground_truth, near_ground_truth,
                                   too_short, diverging_from_20, diverging_below_20, success, mean_iou,
                                   complete)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PublishedRldRow, false_positive_rate, inaccurate)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Condition, name, noise_sigma_m, pose_noise_lateral_m, pose_noise_yaw_rad,
                                   miss_rate, persistent)

}  // namespace conelane

namespace conelane::experiments {
namespace {

/// Data for the report: the figures of the papers, the named conditions, and the gap from which a boundary is
/// drawn as bridged.
std::string published() {
    const std::span<const Condition> known = named_conditions();
    const std::vector<Condition> conditions(known.begin(), known.end());
    return nlohmann::json{{"longest_gap_m", DrivableOptions{}.max_gap_m},
                          {"usual_width_m", DrivableOptions{}.default_width_m},
                          {"conditions", conditions},
                          {"clc", kPublishedClc},
                          {"clc_median_below_ms", kPublishedClcMedianBelow_ms},
                          {"clc_max_ms", kPublishedClcMax_ms},
                          {"rld", kPublishedRld},
                          {"rld_cone_set", kPublishedRldConeSet},
                          {"rld_solved", kPublishedRldSolved},
                          {"rld_mean_ms", kPublishedRldMean_ms},
                          {"rld_p95_ms", kPublishedRldP95_ms},
                          {"rld_standard_deviation_ms", kPublishedRldStandardDeviation_ms}}
        .dump();
}

}  // namespace

void write_report(const std::filesystem::path& results, const std::filesystem::path& page,
                  const std::filesystem::path& pictures, const std::string& wished_python,
                  const std::string& viewer_tracks) {
    require_writable(page);
    const TemporaryFolder folder;
    const std::filesystem::path made_page = folder.path() / "page.html";
    const std::filesystem::path made_pictures = pictures.empty() ? "" : folder.path() / "pictures";
    run_package("report", {results.string(), made_page, published(), made_pictures, viewer_tracks},
                wished_python);
    std::vector<MadeFile> files;
    if (!pictures.empty()) {
        std::error_code failure;
        std::filesystem::create_directories(pictures, failure);
        if (failure) throw InputError(pictures, 0, "", "cannot be made: " + failure.message());
        for (const auto& picture : std::filesystem::directory_iterator(made_pictures)) {
            files.push_back({picture.path(), pictures / picture.path().filename()});
        }
    }
    files.push_back({made_page, page});
    put_in_place(files);
}

}  // namespace conelane::experiments
