#include "experiments/training/front_checkpoint.hpp"

#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

using Json = nlohmann::ordered_json;

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
                {"noise_share", options.scenes.noise_share},
                {"noise_cones", options.scenes.noise_cones},
                {"noise_ranges_m", options.scenes.noise_ranges_m},
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
               {{"parts", options.judge_parts},
                {"steps", options.judge_steps},
                {"learning_rate", options.judge_rate},
                {"trusted", options.trusted},
                {"trust_draws", options.trust_draws}}}};
    if (!options.trust_courses.empty()) json["trust_tracks"] = names_of(options.trust_courses);
    if (options.initial) json["begins_with"] = options.initial_name;
    return json.dump();
}

}  // namespace conelane::experiments
