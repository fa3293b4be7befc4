#include "conelane/bound_certificate.hpp"

#include "model/lane_graph_reference.hpp"

#include <limits>

namespace conelane {
namespace {

/// Prices of 1e15 would hide a lane's cost in the rounding of doubles.
using Real = long double;

constexpr Real kNone = std::numeric_limits<Real>::infinity();
constexpr double kAgreement = 1e-6;
// A walk counts as shorter only if it is shorter by more than this.
constexpr Real kShorter = 1e-12L;

class Verification {
  public:
    Verification(const Scene& scene, const RldParameters& parameters, const BoundCertificate& certificate)
        : p_(parameters),
          certificate_(certificate),
          cones_(scene.cones.size()),
          reference_(scene, parameters) {}

    BoundVerdict run() {
        if (p_.pairing != Pairing::near_far) violated("certificates are for the pairing near_far");
        check_multipliers();
        check_cliques();
        if (!verdict_.violations.empty()) return std::move(verdict_);
        build_arcs();
        if (!shortest_walks()) {
            violated("a walk gains from an endless cycle: the multipliers prove no bound");
            return std::move(verdict_);
        }
        const auto bound = static_cast<double>(combine());
        verdict_.bound = bound;
        if (!(certificate_.bound <= bound + kAgreement)) {
            violated("the bound " + std::to_string(certificate_.bound) +
                     " is claimed, the multipliers prove " + std::to_string(bound));
        }
        return std::move(verdict_);
    }

  private:
    struct Arc {
        std::size_t from;
        std::size_t to;
        Real cost;  ///< reduced, with the multiplier of the cone `to`
    };
    struct Succession {
        std::size_t arc;  ///< the next one
        Real cost;        ///< of the turn
    };
    void violated(std::string what) { verdict_.violations.push_back(std::move(what)); }
    /// Whether (28) or a gap forbids the turn from one edge to another one that it shares the cone with.
    [[nodiscard]] bool is_forbidden_turn(std::size_t i, std::size_t middle, std::size_t k) const {
        if (reference_.exceeds_t_crit(i, middle, k)) return true;
        const bool over_gap =
            reference_.exceeds_s_crit({i, middle}) || reference_.exceeds_s_crit({middle, k});
        return over_gap && !reference_.is_straight(i, middle, k);
    }

    void check_multipliers() {
        if (certificate_.cone_multiplier.size() != cones_)
            violated("the number of multipliers differs from the number of cones");
        const auto bad = [](double multiplier) { return !(multiplier >= 0.0 && std::isfinite(multiplier)); };
        if (std::ranges::any_of(certificate_.cone_multiplier, bad) || bad(certificate_.heading_multiplier) ||
            std::ranges::any_of(certificate_.cliques, bad, &BoundCertificate::Clique::multiplier)) {
            violated("a multiplier is negative or not finite");
        }
    }

    /// Whether (7), (28) or a gap forbids two edges together.
    [[nodiscard]] bool excluded(const Edge& a, const Edge& b) const {
        if (a == b) return false;
        for (const auto& [middle, i] : {std::pair{a.i, a.j}, std::pair{a.j, a.i}}) {
            for (const auto& [other, k] : {std::pair{b.i, b.j}, std::pair{b.j, b.i}}) {
                if (middle == other) return is_forbidden_turn(i, middle, k);
            }
        }
        return (p_.forbid_crossing && reference_.cross(a, b)) || reference_.are_too_close(a, b);
    }

    void check_cliques() {
        for (const BoundCertificate::Clique& clique : certificate_.cliques) {
            for (std::size_t k = 0; k < clique.edges.size(); ++k) {
                const Edge& edge = clique.edges[k];
                if (edge.i >= edge.j || edge.j >= cones_) {
                    violated("a clique holds an invalid edge");
                    return;
                }
                for (std::size_t l = 0; l < k; ++l) {
                    if (!excluded(clique.edges[l], edge)) {
                        violated("a clique holds two edges that may go together");
                        return;
                    }
                }
            }
        }
    }

    void build_arcs() {
        std::map<Edge, Real> clique_multiplier;
        for (const BoundCertificate::Clique& clique : certificate_.cliques) {
            for (const Edge& edge : clique.edges) clique_multiplier[edge] += clique.multiplier;
        }
        std::vector<std::vector<std::size_t>> leaving(cones_);  // arcs by their first cone
        for (std::size_t i = 0; i < cones_; ++i) {
            for (std::size_t j = i + 1; j < cones_; ++j) {
                const Edge edge{i, j};
                if (reference_.exceeds_s_crit(edge) && !reference_.is_over_gap(edge)) continue;
                if (!reference_.has_length(edge) || !reference_.joins_nearest(edge)) continue;
                Real cost = reference_.edge_cost(edge);
                if (reference_.is_along_heading(edge)) cost -= certificate_.heading_multiplier;
                const auto multiplier = clique_multiplier.find(edge);
                if (multiplier != clique_multiplier.end()) cost += multiplier->second;
                for (const auto& [from, to] : {std::pair{i, j}, std::pair{j, i}}) {
                    leaving[from].push_back(arcs_.size());
                    arcs_.push_back({from, to, cost + certificate_.cone_multiplier[to]});
                }
            }
        }
        find_successions(leaving);
    }

    void find_successions(const std::vector<std::vector<std::size_t>>& leaving) {
        successions_.resize(arcs_.size());
        for (std::size_t a = 0; a < arcs_.size(); ++a) {
            const auto& [from, middle, unused] = arcs_[a];
            for (const std::size_t b : leaving[middle]) {
                const std::size_t to = arcs_[b].to;
                if (to == from || is_forbidden_turn(from, middle, to)) continue;
                successions_[a].push_back({b, reference_.turn_cost(from, middle, to)});
            }
        }
    }

    /// Bellman-Ford rounds; false if a negative cycle keeps them from ending.
    bool shortest_walks() {
        walk_.assign(arcs_.size(), kNone);
        for (std::size_t a = 0; a < arcs_.size(); ++a) {
            const std::size_t from = arcs_[a].from;
            if (!reference_.is_near(from)) continue;
            walk_[a] = certificate_.cone_multiplier[from] + reference_.end_cost(from) + arcs_[a].cost;
        }
        for (std::size_t round = 0; round <= arcs_.size(); ++round) {
            bool shorter = false;
            for (std::size_t a = 0; a < arcs_.size(); ++a) {
                if (walk_[a] == kNone) continue;
                for (const auto& [b, turn] : successions_[a]) {
                    const Real length = walk_[a] + turn + arcs_[b].cost;
                    if (!(length < walk_[b] - kShorter)) continue;
                    walk_[b] = length;
                    shorter = true;
                }
            }
            if (!shorter) return true;
        }
        return false;
    }

    /// The cost of the two cheapest walks to far cones within d_max of each other, minus the constant part of
    /// the relaxed constraints, less what rounding may have added.
    [[nodiscard]] Real combine() const {
        std::vector<Real> best(cones_, kNone);
        for (std::size_t a = 0; a < arcs_.size(); ++a) {
            if (!reference_.is_near(arcs_[a].to)) best[arcs_[a].to] = std::min(best[arcs_[a].to], walk_[a]);
        }
        for (std::size_t f = 0; f < best.size(); ++f) {
            if (best[f] < kNone) best[f] += reference_.end_cost(f);
        }
        Real pair = kNone;
        for (std::size_t f = 0; f < best.size(); ++f) {
            for (std::size_t g = f + 1; g < best.size(); ++g) {
                if (reference_.are_apart(f, g)) continue;
                pair = std::min(pair, best[f] + best[g]);
            }
        }
        Real prices = 0.0L;
        for (const double multiplier : certificate_.cone_multiplier) prices += multiplier;
        for (const BoundCertificate::Clique& clique : certificate_.cliques) prices += clique.multiplier;
        const Real of_heading = 2.0L * certificate_.heading_multiplier;
        return pair - (prices - of_heading) - rounding(prices + of_heading);
    }

    /// More than the two walks of a lane graph, whose cones are distinct, and the constant part can be off.
    /// `prices`: the sum of all.
    [[nodiscard]] Real rounding(Real prices) const {
        Real largest = prices;
        for (std::size_t a = 0; a < arcs_.size(); ++a) {
            if (walk_[a] == kNone) continue;
            largest = std::max(largest, prices + std::abs(walk_[a]) + std::abs(arcs_[a].cost));
            for (const Succession& next : successions_[a])
                largest = std::max(largest, prices + std::abs(walk_[a]) + std::abs(next.cost));
        }
        constexpr Real kOfATerm = 4.0L * std::numeric_limits<Real>::epsilon();
        const auto terms = static_cast<Real>(cones_ + certificate_.cliques.size() + 2);
        return 2.0L * static_cast<Real>(cones_) * (kShorter + terms * kOfATerm * largest);
    }

    const RldParameters& p_;
    const BoundCertificate& certificate_;
    std::size_t cones_;
    LaneGraphReference<Real> reference_;
    std::vector<Arc> arcs_;
    std::vector<std::vector<Succession>> successions_;  ///< by arc
    std::vector<Real> walk_;                            ///< the shortest walk that ends with the arc
    BoundVerdict verdict_;
};

}  // namespace

BoundVerdict verify_bound(const Scene& scene, const RldParameters& parameters,
                          const BoundCertificate& certificate) {
    return Verification(scene, parameters, certificate).run();
}

}  // namespace conelane
