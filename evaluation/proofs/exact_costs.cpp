#include "evaluation/proofs/exact_costs.hpp"

#include "conelane/check.hpp"
#include "model/lane_graph_reference.hpp"

#include <algorithm>

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace conelane {
namespace {

using Real = boost::multiprecision::cpp_bin_float_50;

/// Pairs of edges whose distance exceeds d_min by more than this are not tested.
constexpr double kSlack_m = 1e-3;

/// One unit below the rounded-down value: the error of 50 digits is far smaller.
Exact rounded_down(const Real& value) {
    return Exact(boost::multiprecision::floor(ldexp(value, kExactFractionBits))) - 1;
}

class Builder {
  public:
    Builder(const Scene& scene, const RldParameters& parameters)
        : scene_(scene), p_(parameters), without_costs_(parameters), reference_(scene, parameters) {
        without_costs_.facing_weight = 0.0;
        without_costs_.w_color = 0.0;
        without_costs_.learned_costs.reset();
    }

    ExactScene run() {
        find_edges();
        find_excluded();
        find_successions();
        find_ends();
        return std::move(result_);
    }

  private:
    void find_edges() {
        for (std::size_t i = 0; i < scene_.cones.size(); ++i) {
            for (std::size_t j = i + 1; j < scene_.cones.size(); ++j) {
                const CheckReport report = check(scene_, without_costs_, {{{i, j}}});
                if (report.is_final) continue;
                result_.edges.push_back({i, j});
                result_.along_heading.push_back(report.along_heading > 0);
                result_.edge_cost.push_back(rounded_down(reference_.edge_cost({i, j})));
            }
        }
    }

    [[nodiscard]] bool are_far_from_each_other(const Edge& a, const Edge& b) const {
        const auto position = [&](std::size_t cone) -> const Point& { return scene_.cones[cone].position; };
        const double apart =
            (0.5 * (position(a.i) + position(a.j)) - 0.5 * (position(b.i) + position(b.j))).norm();
        const double reach =
            0.5 * (position(a.i) - position(a.j)).norm() + 0.5 * (position(b.i) - position(b.j)).norm();
        return apart > reach + p_.d_min + kSlack_m;
    }

    void find_excluded() {
        const std::size_t count = result_.edges.size();
        result_.excluded.assign(count, boost::dynamic_bitset<>(count));
        for (std::size_t e = 0; e < count; ++e) {
            for (std::size_t f = e + 1; f < count; ++f) {
                if (are_far_from_each_other(result_.edges[e], result_.edges[f])) continue;
                if (!check(scene_, without_costs_, {{result_.edges[e], result_.edges[f]}}).is_final) continue;
                result_.excluded[e].set(f);
                result_.excluded[f].set(e);
            }
        }
    }

    void find_successions() {
        std::vector<std::vector<std::size_t>> leaving(scene_.cones.size());
        for (std::size_t a = 0; a < 2 * result_.edges.size(); ++a) leaving[result_.tail(a)].push_back(a);
        result_.successions.resize(2 * result_.edges.size());
        for (std::size_t a = 0; a < 2 * result_.edges.size(); ++a) {
            for (const std::size_t b : leaving[result_.head(a)]) {
                if (b / 2 == a / 2 || result_.excluded[a / 2][b / 2]) continue;
                // A turn costs the same in both directions.
                const std::size_t back = b ^ 1U;
                const auto known = back < a ? std::ranges::find(result_.successions[back], a ^ 1U,
                                                                &ExactScene::Succession::arc)
                                            : result_.successions[back].end();
                const bool is_known = back < a && known != result_.successions[back].end();
                result_.successions[a].push_back(
                    {b, is_known ? known->cost
                                 : rounded_down(reference_.turn_cost(result_.tail(a), result_.head(a),
                                                                     result_.head(b)))});
            }
        }
    }

    void find_ends() {
        const std::size_t count = scene_.cones.size();
        for (std::size_t cone = 0; cone < count; ++cone) {
            result_.near.push_back(reference_.is_near(cone));
            const bool has_cost = result_.near.back() || p_.learned_costs;
            result_.end_cost.push_back(has_cost ? rounded_down(reference_.end_cost(cone)) : Exact(0));
        }
        result_.partners.assign(count, std::vector<bool>(count, false));
        for (std::size_t f = 0; f < count; ++f) {
            for (std::size_t g = 0; g < count; ++g) {
                if (f == g || result_.near[f] || result_.near[g]) continue;
                result_.partners[f][g] = !reference_.are_apart(f, g);
            }
        }
    }

    const Scene& scene_;
    const RldParameters& p_;
    RldParameters without_costs_;
    LaneGraphReference<Real> reference_;
    ExactScene result_;
};

}  // namespace

Exact exact_below(double value) {
    return Exact(boost::multiprecision::floor(ldexp(Real(value), kExactFractionBits)));
}

std::optional<std::size_t> ExactScene::find(const Edge& edge) const {
    const auto found = std::ranges::lower_bound(edges, edge);
    if (found == edges.end() || *found != edge) return std::nullopt;
    return static_cast<std::size_t>(found - edges.begin());
}

Exact ExactScene::cost_limit() const {
    Exact sum = Exact(1) << kExactFractionBits;
    for (const Exact& cost : edge_cost) {
        if (cost > 0) sum += cost;
    }
    for (std::size_t a = 0; a < successions.size(); ++a) {
        for (const Succession& next : successions[a]) {
            if (a < (next.arc ^ 1U)) sum += next.cost;
        }
    }
    return sum;
}

ExactScene make_exact_scene(const Scene& scene, const RldParameters& parameters) {
    return Builder(scene, parameters).run();
}

}  // namespace conelane
