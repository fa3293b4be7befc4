#include "experiments/training/front_checkpoint.hpp"

#include "evaluation/files/atomic_file.hpp"
#include "evaluation/files/input_error.hpp"
#include "evaluation/files/json_node.hpp"
#include "experiments/training/front_gradient.hpp"

#include <filesystem>

namespace conelane::experiments {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;

Json numbers(const Eigen::ArrayXd& values) {
    return std::vector<double>(values.begin(), values.end());
}

Eigen::ArrayXd array(const JsonNode& node, Eigen::Index size) {
    if (node.array_size() != static_cast<std::size_t>(size))
        node.fail("must have " + std::to_string(size) + " numbers");
    Eigen::ArrayXd result(size);
    for (Eigen::Index i = 0; i < size; ++i) result[i] = node.element(static_cast<std::size_t>(i)).number();
    return result;
}

Json names_of(const std::vector<Track>& courses) {
    Json names = Json::array();
    for (const Track& track : courses) names.push_back(track.name);
    return names;
}

}  // namespace

std::string describe_training(const std::vector<Track>& courses, const FrontTrainingOptions& options) {
    const FrontSearchOptions& search = options.loss.search;
    Json json{{"tracks", names_of(courses)},
              {"seed", options.seed},
              {"draws_per_step", options.draws_per_step},
              {"scenes",
               {{"per_draw", options.scenes.scenes_per_draw},
                {"warp", options.scenes.warp},
                {"respace", options.scenes.respace},
                {"disturb", options.scenes.disturb},
                {"short_sight", options.scenes.short_sight},
                {"other_course", options.scenes.other_course},
                {"colored_share", options.scenes.colored_share},
                {"noise_scenes", options.scenes.noise_scenes},
                {"highest_rate", options.scenes.highest_rate}}},
              {"without", options.without},
              {"only_colors", options.only_colors},
              {"imitation", {{"steps", options.imitation_steps}, {"learning_rate", options.imitation_rate}}},
              {"through_search",
               {{"steps", options.search_steps},
                {"learning_rate", options.search_rate},
                {"beam", search.beam_width},
                {"drop", search.drop},
                {"finished_drop", search.finished_drop},
                {"level_m", search.level_m},
                {"far_m", search.far_m},
                {"listed", options.loss.listed},
                {"fall_out", options.loss.fall_out},
                {"minimum_risk", options.loss.minimum_risk},
                {"listwise", options.loss.listwise},
                {"risk_scale", options.loss.risk_scale},
                {"unusable", options.loss.risk.unusable},
                {"cones", options.loss.risk.cones}}},
              {"judge",
               {{"steps", options.judge_steps},
                {"learning_rate", options.judge_rate},
                {"trusted", options.trusted},
                {"trust_draws", options.trust_draws}}}};
    if (!options.trust_courses.empty()) json["trust_tracks"] = names_of(options.trust_courses);
    if (options.initial) json["begins_with"] = options.initial_name;
    return json.dump();
}

std::optional<FrontCheckpoint> read_front_checkpoint(const std::string& file, const std::string& identity) {
    if (!std::filesystem::exists(file)) return std::nullopt;
    FrontCheckpoint checkpoint;
    with_json_file(file, [&](const JsonNode& node) {
        if (node.member("version").integer() != kVersion)
            node.member("version").fail("must be " + std::to_string(kVersion));
        if (node.member("training").string() != identity) {
            node.member("training").fail("is another training than the one asked for");
        }
        const auto size = static_cast<Eigen::Index>(parameter_count(FrontWeights::zero()));
        checkpoint.step = node.member("step").unsigned_integer();
        checkpoint.values = array(node.member("values"), size);
        checkpoint.adam.first = array(node.member("first"), size);
        checkpoint.adam.second = array(node.member("second"), size);
        checkpoint.adam.first_power = node.member("first_power").number();
        checkpoint.adam.second_power = node.member("second_power").number();
    });
    return checkpoint;
}

void write_front_checkpoint(const std::string& file, const std::string& identity,
                            const FrontCheckpoint& checkpoint) {
    const Json json{{"version", kVersion},
                    {"training", identity},
                    {"step", checkpoint.step},
                    {"values", numbers(checkpoint.values)},
                    {"first", numbers(checkpoint.adam.first)},
                    {"second", numbers(checkpoint.adam.second)},
                    {"first_power", checkpoint.adam.first_power},
                    {"second_power", checkpoint.adam.second_power}};
    AtomicFile output(file);
    output.stream() << json.dump() << '\n';
    output.commit();
}

}  // namespace conelane::experiments
