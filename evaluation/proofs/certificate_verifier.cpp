#include "evaluation/proofs/certificate_verifier.hpp"

#include "conelane/check.hpp"
#include "evaluation/proofs/pair_enumeration.hpp"

#include <stdexcept>

#include <fmt/format.h>

namespace conelane {
namespace {

using Kind = SearchVerdict::Kind;
using Part = SearchCertificate::Part;

/// Tolerance for objectives, which are sums of doubles.
constexpr double kAgreement = 1e-9;

Exact from_units(SearchCertificate::Units units) {
    return Exact(units) << (kExactFractionBits - SearchCertificate::kFractionBits);
}

class Verification {
  public:
    Verification(const Scene& scene, const RldParameters& parameters, const SearchCertificate& certificate,
                 std::int64_t max_steps)
        : scene_(scene),
          p_(parameters),
          certificate_(certificate),
          exact_(make_exact_scene(scene, parameters)) {
        verdict_.kind = Kind::verified;
        steps_left_ = max_steps;
    }

    SearchVerdict run(std::int64_t max_steps) {
        if (std::isnan(certificate_.bound)) refuse("the bound is not a number");
        if (certificate_.bound == -std::numeric_limits<double>::infinity()) refuse("nothing is claimed");
        if (is_open()) check_lane_graph();
        if (is_open()) check_parts();
        verdict_.steps = max_steps - steps_left_;
        return std::move(verdict_);
    }

  private:
    [[nodiscard]] bool is_open() const { return verdict_.kind == Kind::verified; }
    void refuse(std::string reason) {
        verdict_.kind = Kind::refused;
        verdict_.reason = std::move(reason);
    }

    void check_lane_graph() {
        if (!certificate_.lane_graph) return;
        if (!certificate_.objective) return refuse("the lane graph has no objective");
        const CheckReport report = check(scene_, p_, *certificate_.lane_graph);
        if (!report.violations.empty()) return refuse("the lane graph is none: " + report.violations.front());
        const Exact cost = cost_of(*certificate_.lane_graph);
        const double claimed = *certificate_.objective;
        const double tolerance = kAgreement * std::max(1.0, std::abs(claimed));
        if (!(std::abs(claimed) < SearchCertificate::kMaxBound) || cost < exact_below(claimed - tolerance) ||
            cost > exact_below(claimed + tolerance)) {
            return refuse(fmt::format("the lane graph does not cost {}", claimed));
        }
        if (certificate_.bound > claimed) return refuse("the bound is above the lane graph's cost");
        verdict_.is_optimum = claimed - certificate_.bound <= 10.0 * tolerance;
    }

    /// Precondition: the checker accepts it.
    [[nodiscard]] Exact cost_of(const LaneGraph& graph) const {
        Exact sum = 0;
        std::vector<std::size_t> degree(scene_.cones.size(), 0);
        for (const Edge& edge : graph.edges) {
            const std::size_t e = exact_.find(make_edge(edge.i, edge.j)).value();
            sum += exact_.edge_cost[e];
            ++degree[edge.i];
            ++degree[edge.j];
            for (const ExactScene::Succession& next : exact_.successions[2 * e])
                sum += turn_in(graph, 2 * e, next);
            for (const ExactScene::Succession& next : exact_.successions[2 * e + 1])
                sum += turn_in(graph, 2 * e + 1, next);
        }
        for (std::size_t cone = 0; cone < degree.size(); ++cone) {
            if (degree[cone] == 1) sum += exact_.end_cost[cone];
        }
        return sum;
    }
    /// Each turn is stored in both directions; the one from the edge of lower number counts.
    [[nodiscard]] Exact turn_in(const LaneGraph& graph, std::size_t arc,
                                const ExactScene::Succession& next) const {
        const bool counts = arc / 2 < next.arc / 2 &&
                            std::ranges::find(graph.edges, exact_.edges[next.arc / 2]) != graph.edges.end();
        return counts ? next.cost : Exact(0);
    }

    /// Every kind of pair must have a part.
    void check_parts() {
        if (std::isinf(certificate_.bound)) {
            limit_ = exact_.cost_limit();
        } else if (std::abs(certificate_.bound) < SearchCertificate::kMaxBound) {
            limit_ = exact_below(certificate_.bound) + 1;
        } else {
            return refuse("the bound is out of range");
        }
        check_part(std::nullopt);
        if (p_.pairing != Pairing::paper) return;
        for (std::size_t cone = 0; cone < scene_.cones.size() && is_open(); ++cone) {
            const std::vector<bool>& partners = exact_.partners[cone];
            if (std::find(partners.begin() + static_cast<std::ptrdiff_t>(cone), partners.end(), true) ==
                partners.end()) {
                continue;
            }
            check_part(cone);
        }
    }

    /// The legs of one kind of pairs; the first index of each member is the leg's.
    [[nodiscard]] LegKinds kinds_of(std::optional<std::size_t> far_start) const {
        const std::size_t count = scene_.cones.size();
        LegKinds kinds;
        std::vector<bool> far = exact_.near;
        far.flip();
        if (!far_start) {
            kinds.start = {exact_.near};
            kinds.end = {far};
            kinds.partners = &exact_.partners;
            return kinds;
        }
        std::vector<bool> only(count, false);
        only[*far_start] = true;
        std::vector<bool> ends = exact_.partners[*far_start];
        std::fill_n(ends.begin(), *far_start, false);
        kinds.start = {exact_.near, only};
        kinds.end = {exact_.near, ends};
        return kinds;
    }

    void check_part(std::optional<std::size_t> far_start) {
        const auto part = std::ranges::find(certificate_.parts, far_start, &Part::far_start);
        const std::string name = far_start
                                     ? fmt::format("with a far leg from cone {}", scene_.cones[*far_start].id)
                                     : "near to far";
        if (part == certificate_.parts.end() || part->stages.empty())
            return refuse("the part of the pairs " + name + " is missing");
        if (const std::string wrong = wrong_with(*part); !wrong.empty()) return refuse(wrong);
        const LegKinds kinds = kinds_of(far_start);
        WalkGraph graph = all_walks(exact_, kinds);
        std::optional<WalkBounds> bounds;
        for (const SearchCertificate::Stage& stage : part->stages) {
            bounds.emplace(exact_, kinds, prices_of(*part, stage));
            if (!bounds->find(graph)) {
                return refuse("a walk of the pairs " + name + " gains from a cycle: no bound is proven");
            }
            if (bounds->bound() >= limit_) return;
            graph = bounds->below(graph, limit_);
        }
        if (!bounds->find(graph)) return refuse("no bound is proven");
        if (bounds->bound() >= limit_) return;
        PairEnumeration enumeration(exact_, kinds, graph, *bounds, limit_);
        switch (enumeration.run(steps_left_)) {
            case PairEnumeration::Outcome::none_below:
                return;
            case PairEnumeration::Outcome::found_one:
                return refuse("a lane graph costs less than the bound, of the pairs " + name);
            case PairEnumeration::Outcome::too_many_steps:
                verdict_.kind = Kind::unverified;
                verdict_.reason = "needs more steps than allowed, at the pairs " + name;
                return;
        }
    }

    /// Why the part is no valid set of multipliers, in a sentence; empty if it is valid.
    [[nodiscard]] std::string wrong_with(const Part& part) const {
        for (const std::vector<Edge>& clique : part.cliques) {
            for (std::size_t k = 0; k < clique.size(); ++k) {
                const auto edge = exact_.find(clique[k]);
                if (!edge) return "a clique holds an invalid edge";
                for (std::size_t l = 0; l < k; ++l) {
                    if (!exact_.excluded[*edge][exact_.find(clique[l]).value()])
                        return "a clique holds two edges that may go together";
                }
            }
        }
        for (const SearchCertificate::Stage& stage : part.stages) {
            if (stage.cone.size() != scene_.cones.size())
                return "the number of multipliers differs from the number of cones";
            const auto bad = [](SearchCertificate::Units units) {
                return units < 0 || units > SearchCertificate::kMaxUnits;
            };
            if (std::ranges::any_of(stage.cone, bad) || bad(stage.heading) ||
                std::ranges::any_of(stage.clique, [&](const auto& price) { return bad(price.second); })) {
                return "a multiplier is negative or out of range";
            }
            if (std::ranges::any_of(stage.clique,
                                    [&](const auto& price) { return price.first >= part.cliques.size(); })) {
                return "a multiplier belongs to no clique";
            }
        }
        return {};
    }

    [[nodiscard]] WalkPrices prices_of(const Part& part, const SearchCertificate::Stage& stage) const {
        WalkPrices prices;
        const Exact heading = from_units(stage.heading);
        prices.offset = -2 * heading;
        for (const SearchCertificate::Units units : stage.cone) {
            prices.cone.push_back(from_units(units));
            prices.offset += prices.cone.back();
        }
        prices.edge = exact_.edge_cost;
        for (std::size_t e = 0; e < prices.edge.size(); ++e) {
            if (exact_.along_heading[e]) prices.edge[e] -= heading;
        }
        for (const auto& [clique, units] : stage.clique) {
            prices.offset += from_units(units);
            for (const Edge& edge : part.cliques[clique])
                prices.edge[*exact_.find(edge)] += from_units(units);
        }
        return prices;
    }

    const Scene& scene_;
    const RldParameters& p_;
    const SearchCertificate& certificate_;
    const ExactScene exact_;
    Exact limit_ = 0;
    std::int64_t steps_left_ = 0;
    SearchVerdict verdict_;
};

}  // namespace

SearchVerdict verify_search(const Scene& scene, const RldParameters& parameters,
                            const SearchCertificate& certificate, std::int64_t max_steps) {
    try {
        return Verification(scene, parameters, certificate, max_steps).run(max_steps);
    } catch (const std::overflow_error&) {
        return {Kind::unverified, "holds sums beyond 128 bits", 0, false};
    } catch (const std::range_error&) {
        return {Kind::unverified, "holds sums beyond 128 bits", 0, false};
    }
}

}  // namespace conelane
