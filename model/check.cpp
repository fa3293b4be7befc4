#include "conelane/check.hpp"

#include "model/lane_graph_reference.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace conelane {
namespace {

using Real = long double;
constexpr double kAgreement = 1e-6;

class Checker {
  public:
    Checker(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph)
        : scene_(scene), p_(parameters), graph_(graph), reference_(scene, parameters) {}

    CheckReport run() {
        if (!edges_are_simple()) return std::move(report_);
        degrees_and_endpoints();
        paths_and_pairing();
        widths();
        costs();
        return std::move(report_);
    }

  private:
    [[nodiscard]] std::string name(std::size_t cone) const { return std::to_string(scene_.cones[cone].id); }
    [[nodiscard]] std::string name(const Edge& edge) const {
        return "{" + name(edge.i) + ", " + name(edge.j) + "}";
    }
    /// For a violation that more edges may repair.
    void violated(std::string what) { report_.violations.push_back(std::move(what)); }
    void violated_for_good(std::string what) {
        violated(std::move(what));
        report_.is_final = true;
    }

    bool edges_are_simple() {
        std::set<std::pair<std::size_t, std::size_t>> seen;
        for (const Edge& edge : graph_.edges) {
            if (edge.i >= scene_.cones.size() || edge.j >= scene_.cones.size()) {
                violated_for_good("an edge ends at a cone that the scene does not have");
                return false;
            }
            if (edge.i == edge.j) violated_for_good("edge " + name(edge) + " is a loop");
            if (!seen.emplace(std::min(edge.i, edge.j), std::max(edge.i, edge.j)).second) {
                violated_for_good("edge " + name(edge) + " is there twice");
            }
            neighbours_[edge.i].push_back(edge.j);
            neighbours_[edge.j].push_back(edge.i);
        }
        return report_.violations.empty();
    }

    void degrees_and_endpoints() {
        std::vector<std::size_t> near_ends, far_ends;
        for (const auto& [cone, others] : neighbours_) {
            if (others.size() > 2)
                violated_for_good("(2) cone " + name(cone) + " has degree " + std::to_string(others.size()));
            if (others.size() == 1) (reference_.is_near(cone) ? near_ends : far_ends).push_back(cone);
        }
        const std::size_t ends = near_ends.size() + far_ends.size();
        if (ends != 4) violated("(3) " + std::to_string(ends) + " endpoints instead of 4");
        if (near_ends.size() != 2)
            violated("(11) " + std::to_string(near_ends.size()) + " near endpoints instead of 2");
        for (std::size_t a = 0; a < far_ends.size(); ++a) {
            for (std::size_t b = a + 1; b < far_ends.size(); ++b) {
                if (reference_.are_apart(far_ends[a], far_ends[b])) {
                    violated("(17) far endpoints " + name(far_ends[a]) + " and " + name(far_ends[b]) +
                             " are more than d_max apart");
                }
            }
        }
    }

    /// Connected components; a component with as many edges as cones holds a cycle.
    void paths_and_pairing() {
        std::set<std::size_t> visited;
        for (const auto& [start, unused] : neighbours_) {
            if (visited.contains(start)) continue;
            std::vector<std::size_t> open{start}, component;
            visited.insert(start);
            while (!open.empty()) {
                const std::size_t cone = open.back();
                open.pop_back();
                component.push_back(cone);
                for (const std::size_t next : neighbours_[cone]) {
                    if (visited.insert(next).second) open.push_back(next);
                }
            }
            std::size_t degrees = 0;
            std::size_t near_ends = 0;
            for (const std::size_t cone : component) {
                degrees += neighbours_[cone].size();
                if (neighbours_[cone].size() == 1 && reference_.is_near(cone)) ++near_ends;
            }
            if (degrees / 2 >= component.size()) violated_for_good("(5) a cycle through cone " + name(start));
            if (p_.pairing == Pairing::near_far && near_ends == 2) {
                violated("pairing: the path through cone " + name(start) + " joins both near endpoints");
            }
        }
    }

    void widths() {
        for (std::size_t e = 0; e < graph_.edges.size(); ++e) {
            for (std::size_t f = e + 1; f < graph_.edges.size(); ++f) {
                const Edge& a = graph_.edges[e];
                const Edge& b = graph_.edges[f];
                if (a.i == b.i || a.i == b.j || a.j == b.i || a.j == b.j) continue;
                if (reference_.are_too_close(a, b))
                    violated_for_good("(6) edges " + name(a) + " and " + name(b) + " are closer than d_min");
                if (p_.forbid_crossing && reference_.cross(a, b))
                    violated_for_good("crossing: edges " + name(a) + " and " + name(b) + " cross");
            }
        }
    }

    void costs() {
        Real sum = 0;
        for (const Edge& edge : graph_.edges) {
            if (reference_.exceeds_s_crit(edge) && !reference_.is_over_gap(edge))
                violated_for_good("(27) edge " + name(edge) + " exceeds s_crit");
            if (!reference_.has_length(edge)) violated_for_good("edge " + name(edge) + " has no length");
            if (!reference_.joins_nearest(edge))
                violated_for_good("nearest: at both cones of edge " + name(edge) + ", too many are nearer");
            if (reference_.is_along_heading(edge)) ++report_.along_heading;
            sum += reference_.edge_cost(edge);
        }
        if (report_.along_heading < 2)
            violated("(9) " + std::to_string(report_.along_heading) +
                     " edges along the heading instead of 2");
        for (const auto& [cone, others] : neighbours_) {
            if (others.size() == 1) sum += reference_.end_cost(cone);
            for (std::size_t a = 0; a < others.size(); ++a) {
                for (std::size_t b = a + 1; b < others.size(); ++b) sum += turn(others[a], cone, others[b]);
            }
        }
        report_.objective = static_cast<double>(sum);
    }

    /// The cost of the turn.
    Real turn(std::size_t from, std::size_t middle, std::size_t to) {
        if (reference_.exceeds_t_crit(from, middle, to))
            violated_for_good("(28) the angle at cone " + name(middle) + " exceeds t_crit");
        const bool over_gap =
            reference_.exceeds_s_crit({from, middle}) || reference_.exceeds_s_crit({middle, to});
        if (over_gap && !reference_.is_straight(from, middle, to))
            violated_for_good("gap: the angle at cone " + name(middle) + " exceeds theta_gap");
        return reference_.turn_cost(from, middle, to);
    }

    const Scene& scene_;
    const RldParameters& p_;
    const LaneGraph& graph_;
    LaneGraphReference<Real> reference_;
    std::map<std::size_t, std::vector<std::size_t>> neighbours_;
    CheckReport report_;
};

}  // namespace

CheckReport check(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph) {
    return Checker(scene, parameters, graph).run();
}

CheckReport check(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph,
                  const Claim& claim) {
    CheckReport report = check(scene, parameters, graph);
    if (!report.objective) return report;
    const double tolerance = kAgreement * std::max(1.0, std::abs(*report.objective));
    if (!(std::abs(claim.objective - *report.objective) <= tolerance)) {
        report.violations.push_back("objective " + std::to_string(claim.objective) + " is claimed, " +
                                    std::to_string(*report.objective) + " is right");
    }
    if (claim.bound && !(*claim.bound <= *report.objective + tolerance)) {
        report.violations.emplace_back("the bound is above the objective");
    }
    if (claim.optimal &&
        !(claim.bound && *report.objective - *claim.bound <= claim.absolute_gap + tolerance)) {
        report.violations.emplace_back("optimal is claimed without a bound within the gap");
    }
    return report;
}

}  // namespace conelane
