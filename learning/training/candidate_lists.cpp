#include "learning/training/candidate_lists.hpp"

#include "evaluation/progress/parallel.hpp"
#include "evaluation/progress/progress.hpp"
#include "evaluation/scoring/divergence.hpp"
#include "evaluation/scoring/lane_iou.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/seeded_random.hpp"
#include "evaluation/world/ground_truth.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <utility>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_int_distribution.hpp>

namespace conelane::learning {
namespace {

constexpr double kNever_m = std::numeric_limits<double>::infinity();

/// `count` of the numbers below `size`, ascending; all such sets are equally likely.
std::vector<std::size_t> draw(std::size_t count, std::size_t size, const std::string& scene_id,
                              std::uint64_t seed) {
    std::vector<std::size_t> numbers(size);
    std::iota(numbers.begin(), numbers.end(), std::size_t{0});
    if (count == 0 || count >= size) return numbers;
    boost::random::mt19937_64 random = generator_of(scene_id, seed);
    for (std::size_t i = 0; i < count; ++i) {
        boost::random::uniform_int_distribution<std::size_t> rest(i, size - 1);
        std::swap(numbers[i], numbers[rest(random)]);
    }
    numbers.resize(count);
    std::ranges::sort(numbers);
    return numbers;
}

using IndexById = std::unordered_map<ConeId, std::size_t>;

LaneOutline outline(const Lane& lane, const Scene& scene, const IndexById& index_of) {
    LaneOutline result;
    for (const ConeId id : lane.left) result.left.push_back(scene.cones[index_of.at(id)].position);
    for (const ConeId id : lane.right) result.right.push_back(scene.cones[index_of.at(id)].position);
    result.closed = lane.closed;
    return result;
}

}  // namespace

double CandidateList::best_iou() const {
    return iou.empty() ? 0.0 : *std::ranges::max_element(iou);
}

std::vector<CandidateList> enumerate_candidates(const SceneSet& set, const CandidateListOptions& options) {
    std::vector<const AnnotatedScene*> counted;
    for (const AnnotatedScene& scene : set.scenes) {
        if (counts(scene)) counted.push_back(&scene);
    }
    std::vector<CandidateList> lists(counted.size());
    Progress progress("candidates", options.show_progress ? counted.size() : 0);
    in_parallel(
        counted.size(), options.threads, [&] { return CandidateSearch(options.search); },
        [&](CandidateSearch& search, std::size_t i) {
            const AnnotatedScene& scene = *counted[i];
            CandidateSearch::Request request;
            request.with_features = true;
            (void)search.run(scene.scene, request);
            const PathPairs& pairs = search.pairs();
            const IndexById index_of = index_by_id(scene.scene);
            const LaneOutline ground_truth = outline(*scene.ground_truth, scene.scene, index_of);
            const double ground_truth_length_m = lane_length_m(ground_truth);
            const TrackBoundaries& annotated = set.tracks.at(scene.track);
            CandidateList& list = lists[i];
            list.track = scene.track;
            list.false_positive_rate = scene.false_positive_rate.value_or(0.0);
            list.range_m = scene.range_m.value_or(0.0);
            for (const std::size_t k :
                 draw(options.max_per_scene, pairs.found().size(), scene.scene.id, options.seed)) {
                list.lanes.push_back(pairs.features()[k]);
                const LaneOutline lane =
                    outline(search.lane(pairs.found()[k], scene.scene), scene.scene, index_of);
                // Candidates satisfy the constraints.
                list.iou.push_back(intersection_over_union_of_simple(lane, ground_truth));
                const std::optional<double> diverges_m = divergence_m(lane, ground_truth, annotated);
                list.divergence_m.push_back(diverges_m.value_or(kNever_m));
                list.usable.push_back(is_usable(lane_length_m(lane), ground_truth_length_m, diverges_m));
            }
            progress.advance();
        });
    return lists;
}

}  // namespace conelane::learning
