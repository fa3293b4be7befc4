#include "model/answer_verification.hpp"

#include <array>

namespace conelane {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

class Verification {
  public:
    Verification(const LaneGraphProblem& problem, const LaneGraph& graph)
        : problem_(problem), graph_(graph) {}

    VerifiedAnswer run() {
        if (take_edges() && check_turns() && check_conflicts() && walk_paths()) {
            check_heading();
        }
        return {std::move(violation_), cost_};
    }

  private:
    bool fail(std::string violation) {
        violation_ = std::move(violation);
        return false;
    }

    static std::string name(std::size_t i, std::size_t j) {
        return std::to_string(i) + " - " + std::to_string(j);
    }
    [[nodiscard]] std::string name(std::size_t edge) const {
        return name(problem_.edges[edge].i, problem_.edges[edge].j);
    }

    /// (27): each edge is listed, allowed, and chosen once. At most two edges meet at a cone.
    bool take_edges() {
        const std::size_t n = problem_.cone_count;
        chosen_.assign(problem_.edges.size(), 0);
        neighbours_.assign(n, {kNone, kNone});
        for (std::size_t k = 0; k < graph_.edges.size(); ++k) {
            const Edge& edge = graph_.edges[k];
            if (edge.i >= n || edge.j >= n)
                return fail("edge " + name(edge.i, edge.j) + " is not in the problem");
            if (k > 0 && !(graph_.edges[k - 1] < edge)) return fail("edges are not in ascending order");
            if (!link(edge.i, edge.j) || !link(edge.j, edge.i)) return false;
        }
        std::size_t listed = 0;
        for (std::size_t e = 0; e < problem_.edges.size(); ++e) {
            const ProblemEdge& edge = problem_.edges[e];
            const bool linked = neighbours_[edge.i][0] == edge.j || neighbours_[edge.i][1] == edge.j;
            if (!linked) continue;
            if (edge.high_cost) return fail("(27) edge " + name(e) + " costs too much");
            chosen_[e] = 1;
            cost_ += edge.cost;
            along_heading_ += edge.along_heading ? 1 : 0;
            ++listed;
        }
        return listed == graph_.edges.size() || fail("an edge is not in the problem");
    }

    bool link(std::size_t cone, std::size_t other) {
        for (std::size_t& place : neighbours_[cone]) {
            if (place != kNone) continue;
            place = other;
            return true;
        }
        return fail("cone " + std::to_string(cone) + " has more than two edges");
    }

    /// (28). Adds the cost of the turn at every cone with two edges.
    bool check_turns() {
        std::size_t turns = 0;
        for (const ProblemTurn& turn : problem_.turns) {
            if (chosen_[turn.edge_i] == 0 || chosen_[turn.edge_k] == 0) continue;
            if (turn.high_cost) {
                return fail("(28) the turn of edges " + name(turn.edge_i) + " and " + name(turn.edge_k) +
                            " costs too much");
            }
            cost_ += turn.cost;
            ++turns;
        }
        const auto inner = static_cast<std::size_t>(std::ranges::count_if(
            neighbours_, [](const std::array<std::size_t, 2>& pair) { return pair[1] != kNone; }));
        return turns == inner || fail("a turn of two edges is not in the problem");
    }

    /// (6)-(8).
    bool check_conflicts() {
        for (const auto& [first, second] : problem_.conflicts) {
            if (chosen_[first] != 0 && chosen_[second] != 0) {
                return fail("(7) edges " + name(first) + " and " + name(second) + " come too close");
            }
        }
        return true;
    }

    /// (2)-(5): exactly two paths, whose ends keep (11)-(17) and the pairing.
    bool walk_paths() {
        std::vector<char> seen(problem_.cone_count, 0);
        std::size_t paths = 0;
        std::size_t walked = 0;
        std::array<std::size_t, 4> ends{};
        for (std::size_t cone = 0; cone < problem_.cone_count; ++cone) {
            const bool is_end = neighbours_[cone][0] != kNone && neighbours_[cone][1] == kNone;
            if (!is_end || seen[cone] != 0) continue;
            if (++paths > 2) return fail("there are more than two paths");
            ends[2 * paths - 2] = cone;
            std::size_t last = kNone;
            std::size_t here = cone;
            while (true) {
                seen[here] = 1;
                const auto& [a, b] = neighbours_[here];
                const std::size_t next = a != last ? a : b;
                if (next == kNone) break;
                last = here;
                here = next;
                ++walked;
            }
            ends[2 * paths - 1] = here;
        }
        if (paths != 2) return fail("there are not two paths but " + std::to_string(paths));
        if (walked != graph_.edges.size()) return fail("edges form a cycle");
        return check_ends(ends);
    }

    bool check_ends(const std::array<std::size_t, 4>& ends) {
        std::array<std::size_t, 4> far{};
        std::size_t far_count = 0;
        for (const std::size_t end : ends) {
            if (!problem_.near[end]) far[far_count++] = end;
        }
        if (far_count != 2)
            return fail(std::to_string(4 - far_count) + " near and " + std::to_string(far_count) +
                        " far ends, not two of each");
        if (problem_.parameters.pairing == Pairing::near_far &&
            problem_.near[ends[0]] == problem_.near[ends[1]]) {
            return fail("a path does not run from a near cone to a far one");
        }
        for (const auto& [i, j] : problem_.far_apart) {
            if ((i == far[0] && j == far[1]) || (i == far[1] && j == far[0])) {
                return fail("(17) far ends " + name(i, j) + " are too far apart");
            }
        }
        return true;
    }

    /// (9).
    void check_heading() {
        if (along_heading_ < 2) fail("(9) fewer than two edges are along the heading");
    }

    const LaneGraphProblem& problem_;
    const LaneGraph& graph_;
    std::vector<char> chosen_;
    std::vector<std::array<std::size_t, 2>> neighbours_;  ///< by cone
    double cost_ = 0.0;
    int along_heading_ = 0;
    std::string violation_;
};

}  // namespace

VerifiedAnswer verify_answer(const LaneGraphProblem& problem, const LaneGraph& graph) {
    return Verification(problem, graph).run();
}

}  // namespace conelane
