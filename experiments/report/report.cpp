#include "experiments/report/report.hpp"

#include "conelane/drivable_lane.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/scoring/published_figures.hpp"
#include "evaluation/world/condition.hpp"
#include "experiments/report/package.hpp"

#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

/// Data for the report: the figures of the papers, the named conditions, and the gap from which a boundary is
/// drawn as bridged.
std::string published() {
    nlohmann::ordered_json clc = nlohmann::ordered_json::array();
    for (const PublishedClcRow& row : kPublishedClc) {
        clc.push_back({{"rate", row.false_positive_rate},
                       {"ground_truth", row.ground_truth},
                       {"near_ground_truth", row.near_ground_truth},
                       {"too_short", row.too_short},
                       {"diverging_from_20", row.diverging_from_20},
                       {"diverging_below_20", row.diverging_below_20},
                       {"success", row.success},
                       {"mean_iou", row.mean_iou},
                       {"complete", row.complete}});
    }
    nlohmann::ordered_json rld = nlohmann::ordered_json::array();
    for (const PublishedRldRow& row : kPublishedRld) {
        rld.push_back({{"rate", row.false_positive_rate},
                       {"ratio", row.printed_ratio},
                       {"inaccurate", row.inaccurate},
                       {"upper_bound", row.upper_bound}});
    }
    nlohmann::ordered_json conditions = nlohmann::ordered_json::array();
    for (const Condition& condition : named_conditions()) {
        conditions.push_back({{"name", condition.name},
                              {"noise_m", condition.noise_sigma_m},
                              {"pose_lateral_m", condition.pose_noise_lateral_m},
                              {"pose_yaw_rad", condition.pose_noise_yaw_rad},
                              {"miss_rate", condition.miss_rate},
                              {"persistent", condition.persistent}});
    }
    return nlohmann::ordered_json{{"longest_gap_m", DrivableOptions{}.max_gap_m},
                                  {"usual_width_m", DrivableOptions{}.default_width_m},
                                  {"conditions", conditions},
                                  {"clc", clc},
                                  {"clc_median_below_ms", kPublishedClcMedianBelow_ms},
                                  {"clc_max_ms", kPublishedClcMax_ms},
                                  {"rld", rld},
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
