#include "graph_search/front/front_search.hpp"

#include "conelane/invalid_input.hpp"

#include <tuple>

namespace conelane {
namespace {

constexpr std::size_t kBits = decltype(FrontSearch::Node::bits){}.size();

/// The difference of each score and the best other score.
class Margins {
  public:
    explicit Margins(std::span<const float> scores) {
        for (const float score : scores) {
            if (score > best_) {
                second_ = std::exchange(best_, score);
            } else {
                second_ = std::max(second_, score);
            }
        }
    }
    /// kNoOther if there is none.
    [[nodiscard]] float of(float score) const {
        constexpr float kNoOther = 100.0F;
        return std::min(kNoOther, score - (score == best_ ? second_ : best_));
    }

  private:
    float best_ = -std::numeric_limits<float>::infinity();
    float second_ = -std::numeric_limits<float>::infinity();
};

}  // namespace

void validate(const FrontSearchOptions& options) {
    if (options.beam_width < 1) throw InvalidInput("beam_width", "must be at least 1");
    if (!(options.drop > 0.0)) throw InvalidInput("drop", "must be positive");
    if (!(options.finished_drop > 0.0)) throw InvalidInput("finished_drop", "must be positive");
    if (!(options.level_m > 0.0 && std::isfinite(options.level_m)))
        throw InvalidInput("level_m", "must be positive");
    if (!(options.far_m >= 0.0)) throw InvalidInput("far_m", "must not be negative");
}

void FrontSearch::begin(const Scene& scene, FrontCost& cost, const FrontSearchOptions& options,
                        FrontEvidence* evidence, SearchBudget& budget) {
    cost_ = &cost;
    evidence_ = evidence;
    options_ = options;
    map_.build(scene, budget);
    if (evidence != nullptr) evidence->find_again(scene, map_);
    nodes_.clear();
    finished_.clear();
    best_finished_ = -std::numeric_limits<double>::infinity();
    level_.clear();
    for (std::vector<Candidate>& level : levels_) level.clear();
    next_level_ = 0;
    open_lane_ = kNone;
    expanded_ = 0;
    left_out_ = budget.stopped_by.has_value();
    if (left_out_) return;
    starts_.list(map_, options_.rules);
    left_out_ = starts_.left_out;
    const std::span<const float> scores = cost.score_starts(map_, starts_);
    const Margins margins(scores);
    for (std::size_t i = 0; i < scores.size(); ++i) {
        const auto& [left, right] = starts_.pairs[i];
        const Vertex left_cone = starts_.cones[kLeft][left];
        const Vertex right_cone = starts_.cones[kRight][right];
        const double score =
            static_cast<double>(scores[i]) + bonus(kLeft, left_cone) + bonus(kRight, right_cone);
        push(level_of(start_state(map_, left_cone, right_cone)),
             {score, kNone, {}, kLeft, i, margins.of(scores[i])});
    }
}

bool FrontSearch::advance(SearchBudget& budget) {
    while (next_level_ < levels_.size() && levels_[next_level_].empty()) ++next_level_;
    level_.clear();
    if (next_level_ == levels_.size() || budget.read_clock()) return false;
    keep_best();
    levels_[next_level_].clear();
    ++next_level_;
    for (const std::size_t number : level_) {
        expand(number);
        if (budget.read_clock()) return false;
    }
    return !budget.occupy(nodes_.size() * sizeof(Node) + map_.memory_bytes());
}

void FrontSearch::run(SearchBudget& budget) {
    while (advance(budget)) {
    }
    left_out_ = left_out_ || map_.left_out_edges();
}

void FrontSearch::keep_best() {
    const std::vector<Candidate>& candidates = levels_[next_level_];
    const bool is_far = static_cast<double>(next_level_) * options_.level_m >= 2.0 * options_.far_m;
    const std::size_t width = is_far ? (options_.beam_width - 1) / 3 + 1 : options_.beam_width;
    // A heap, because only few of them are taken.
    const auto is_worse = [](const Rank& a, const Rank& b) {
        return std::tuple(-a.score, a.candidate) > std::tuple(-b.score, b.candidate);
    };
    ranks_.clear();
    for (std::size_t i = 0; i < candidates.size(); ++i) ranks_.push_back({candidates[i].score, i});
    std::ranges::make_heap(ranks_, is_worse);
    for (; !ranks_.empty(); ranks_.pop_back()) {
        const Candidate& candidate = candidates[ranks_.front().candidate];
        std::ranges::pop_heap(ranks_, is_worse);
        const bool is_behind =
            candidate.score < best_finished_ - options_.finished_drop ||
            (!level_.empty() && candidate.score < nodes_[level_.front()].score - options_.drop);
        if (is_behind || level_.size() == width) {
            left_out_ = true;
            break;
        }
        const std::size_t number = add(candidate);
        if (number == kNone) continue;
        if (options_.merge && is_kept_front(nodes_[number].state)) {
            left_out_ = true;
            nodes_.pop_back();
            continue;
        }
        level_.push_back(number);
    }
    const auto lane =
        std::ranges::find_if(level_, [&](std::size_t number) { return nodes_[number].state.is_lane(); });
    if (lane != level_.end()) open_lane_ = *lane;
}

void FrontSearch::expand(std::size_t number) {
    ++expanded_;
    const Side side = moving_side(map_, nodes_[number].state);
    moves_.list(map_, nodes_[number].state, side, options_.rules);
    left_out_ = left_out_ || moves_.left_out;
    const std::span<const float> scores = cost_->score_moves(map_, nodes_[number].state, side, moves_);
    const Margins margins(scores);
    const Node& from = nodes_[number];
    const std::span<const FrontEdge> edges = map_.edges(from.state.ends[side].cones[0]);
    const std::size_t level = level_number();
    for (std::size_t i = 0; i < moves_.extensions.size(); ++i) {
        const FrontMove& move = moves_.extensions[i];
        const auto ahead_m = static_cast<double>(edges[move.edge].length_m);
        const double progress_m =
            from.state.ends[kLeft].length_m + from.state.ends[kRight].length_m + ahead_m;
        const double score = from.score + static_cast<double>(scores[i]) + bonus(side, move.to);
        push(std::max(level + 1, static_cast<std::size_t>(progress_m / options_.level_m)),
             {score, number, move, side, from.start, margins.of(scores[i])});
    }
    if (!moves_.stops) return;
    const double score = from.score + static_cast<double>(scores.back());
    if (!from.state.ends[opposite(side)].stopped) {
        push(level_after(level, from.state),
             {score, number, {}, side, from.start, margins.of(scores.back())});
    } else if (from.state.is_lane()) {
        finished_.push_back({number, side, score});
        best_finished_ = std::max(best_finished_, score);
    }
}

void FrontSearch::push(std::size_t level, const Candidate& candidate) {
    if (level >= levels_.size()) levels_.resize(level + 1);
    levels_[level].push_back(candidate);
}

std::size_t FrontSearch::level_of(const FrontState& state) const {
    return static_cast<std::size_t>((state.ends[kLeft].length_m + state.ends[kRight].length_m) /
                                    options_.level_m);
}

std::size_t FrontSearch::add(const Candidate& candidate) {
    Node node{candidate, {}, 0.0, {}};
    if (candidate.parent == kNone) {
        const auto& [left, right] = starts_.pairs[candidate.start];
        node.state = start_state(map_, starts_.cones[kLeft][left], starts_.cones[kRight][right]);
        node.bonus =
            bonus(kLeft, node.state.ends[kLeft].cones[0]) + bonus(kRight, node.state.ends[kRight].cones[0]);
        for (const FrontEnd& end : node.state.ends) node.bits.set(end.cones[0] % kBits);
    } else {
        if (!candidate.move.stops() && !is_free(candidate.parent, candidate.side, candidate.move.to))
            return kNone;
        node.state = moved(map_, nodes_[candidate.parent].state, candidate.side, candidate.move);
        node.bits = nodes_[candidate.parent].bits;
        node.bonus = nodes_[candidate.parent].bonus;
        if (!candidate.move.stops()) {
            node.bonus += bonus(candidate.side, candidate.move.to);
            node.bits.set(candidate.move.to % kBits);
        }
    }
    nodes_.push_back(node);
    return nodes_.size() - 1;
}

bool FrontSearch::is_kept_front(const FrontState& state) const {
    return std::ranges::any_of(level_,
                               [&](std::size_t number) { return nodes_[number].state.same_front(state); });
}

bool FrontSearch::is_on_lane(std::size_t number, Vertex cone) const {
    if (!nodes_[number].bits[cone % kBits]) return false;
    if (map_.size() <= kBits) return true;
    for (; number != kNone; number = nodes_[number].parent) {
        const Node& node = nodes_[number];
        if (node.state.ends[kLeft].cones[0] == cone || node.state.ends[kRight].cones[0] == cone) return true;
    }
    return false;
}

bool FrontSearch::is_free(std::size_t number, Side side, Vertex to) const {
    if (is_on_lane(number, to)) return false;
    const Vertex last = nodes_[number].state.ends[side].cones[0];
    const Segment added{map_.position(last), map_.position(to)};
    for (; number != kNone; number = nodes_[number].parent) {
        const Node& node = nodes_[number];
        if (node.parent == kNone) {
            const Vertex facing = node.state.ends[opposite(side)].cones[0];
            return foot_point(map_.position(facing), added).distance_m >=
                   narrowest_between_m(map_, to, facing, options_.rules);
        }
        if (node.move.stops()) continue;
        const std::array<Vertex, 3>& cones = node.state.ends[node.side].cones;
        const Segment segment{map_.position(cones[1]), map_.position(cones[0])};
        const double narrowest_m = narrowest_between_m(map_, to, cones[0], options_.rules);
        if (node.side == side) {
            if (cones[0] != last && !far_apart(added, segment, 0.0) && segments_intersect(added, segment))
                return false;
        } else if (come_within(added, segment, narrowest_m)) {
            return false;
        }
    }
    return true;
}

void FrontSearch::sort_finished(std::size_t count) {
    count = std::min(count, finished_.size());
    std::partial_sort(finished_.begin(), finished_.begin() + static_cast<std::ptrdiff_t>(count),
                      finished_.end(), [](const Finished& a, const Finished& b) {
                          return std::tuple(-a.score, a.parent) < std::tuple(-b.score, b.parent);
                      });
}

void FrontSearch::cones(std::size_t number, std::array<std::vector<Vertex>, 2>& cones) const {
    for (std::vector<Vertex>& side : cones) side.clear();
    for (; nodes_[number].parent != kNone; number = nodes_[number].parent) {
        const Node& node = nodes_[number];
        if (!node.move.stops()) cones[node.side].push_back(node.move.to);
    }
    for (const Side side : {kLeft, kRight}) {
        cones[side].push_back(nodes_[number].state.ends[side].cones[0]);
        std::ranges::reverse(cones[side]);
    }
}

FrontEvidence::FrontEvidence(double bonus) : bonus_(bonus) {
    if (!(bonus >= 0.0 && std::isfinite(bonus))) throw InvalidInput("repeat_bonus", "must be at least 0");
}

void FrontEvidence::remember(const Lane& lane) {
    remembered_.clear();
    for (const ConeId id : lane.left) remembered_.emplace_back(id, bit_of(kLeft));
    for (const ConeId id : lane.right) remembered_.emplace_back(id, bit_of(kRight));
    std::ranges::sort(remembered_);
}

void FrontEvidence::find_again(const Scene& scene, const FrontMap& map) {
    sides_.assign(map.size(), 0);
    if (remembered_.empty()) return;
    for (Vertex cone = 0; cone < map.size(); ++cone) {
        const ConeId id = scene.cones[map.scene_index(cone)].id;
        const auto known =
            std::ranges::lower_bound(remembered_, id, {}, &std::pair<ConeId, std::uint8_t>::first);
        if (known != remembered_.end() && known->first == id) sides_[cone] = known->second;
    }
}

}  // namespace conelane
