// Readers of weights: of `front`, of the network of `clc`, of step scores. Weights that are read are valid,
// and after writing they read the same.

#include "evaluation/formats/weights_file.hpp"
#include "tests/fuzz/expectations.hpp"

namespace conelane::fuzz {
namespace {

void read_all(std::string_view bytes) {
    answers([&] {
        const FrontWeights weights = conelane::parse_front_weights(bytes);
        validate(weights);
        require(conelane::parse_front_weights(front_weights_json(weights, "{}")) == weights,
                "weights are read as they were written");
    });
    answers([&] {
        const RankNetWeights weights = conelane::parse_rank_net(bytes);
        (void)make_rank_net(weights);
        const std::string json = conelane::rank_net_json(weights, "{}");
        require(rank_net_json(parse_rank_net(json), "{}") == json, "weights are read as they were written");
    });
    answers([&] {
        const StepScores scores = conelane::parse_step_scores(bytes);
        const std::string json = step_scores_json(scores, conelane::step_scores_training(bytes));
        require(step_scores_json(parse_step_scores(json), step_scores_training(json)) == json,
                "scores are read as they were written");
    });
}

}  // namespace
}  // namespace conelane::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    conelane::fuzz::read_all({reinterpret_cast<const char*>(data), size});
    return 0;
}
