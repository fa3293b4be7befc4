#include "solvers/path_pair/bound/smoothed_ascent.hpp"

namespace conelane::path_pair {
namespace {

constexpr double kMinWeight = 1e-290;
constexpr double kMinRest = 1e-13;  ///< of a total: smaller differences are rounding
constexpr std::size_t kWorkPerArc = 30;
constexpr std::size_t kWorkPerTurn = 6;
constexpr std::size_t kWorkPerExponential = 20;

/// By what the first weight is multiplied and the second one divided, so that both totals have the same
/// share of it.
double balance(double first, double first_total, double second, double second_total) {
    if (!(first > kMinWeight && second > kMinWeight)) return 1.0;
    const double first_rest = std::max(first_total - first, kMinRest * first_total);
    const double second_rest = std::max(second_total - second, kMinRest * second_total);
    return std::sqrt(second / second_rest * (first_rest / first));
}

}  // namespace

bool SmoothedAscent::find(const ResidualGraph& residual, CliquePool& cliques, Multipliers& multipliers) {
    begin(residual, multipliers.heading);
    for (double temperature = tuning_.first_temperature;; temperature *= tuning_.cooling) {
        add_members(cliques);
        if (!set_weights(temperature)) return false;
        for (int s = 0; s < tuning_.sweeps; ++s) {
            if (!sweep()) return false;
        }
        const double next = temperature * tuning_.cooling;
        if (temperature < tuning_.clique_temperatures[0] && next > tuning_.clique_temperatures[1])
            separate(cliques);
        absorb(temperature);
        if (next < tuning_.last_temperature) return read(cliques, multipliers);
    }
}

void SmoothedAscent::begin(const ResidualGraph& residual, double heading) {
    residual_ = &residual;
    sweeps_ = 0;
    cost_.clear();
    in_price_.clear();
    edge_alive_.assign(to_index(graph_.edge_count()), 0);
    arcs_of_edge_.assign(to_index(graph_.edge_count()), {-1, -1});
    starts_.clear();
    ends_.clear();
    for (int a = 0; a < residual.size(); ++a) {
        const int edge = residual.edge(a);
        cost_.push_back(graph_.cost(edge) - (graph_.along_heading(edge) ? heading : 0.0));
        in_price_.push_back(0.5 * cost_.back());
        edge_alive_[to_index(edge)] = 1;
        arcs_of_edge_[to_index(edge)][to_index(residual.arc[to_index(a)] % 2)] = a;
    }
    out_price_ = in_price_;
    for (int cone = 0; cone < graph_.cone_count(); ++cone) {
        if (system_.kinds[0].start[to_index(cone)] != 0) starts_.push_back(cone);
        if (system_.kinds[0].end[to_index(cone)] != 0) ends_.push_back(cone);
    }
    start_.assign(to_index(graph_.cone_count()), {});
    end_.assign(to_index(graph_.cone_count()), {});
    members_.clear();
    member_start_.assign(1, 0);
}

void SmoothedAscent::add_members(const CliquePool& cliques) {
    for (int q = static_cast<int>(member_start_.size()) - 1; q < cliques.size(); ++q) {
        for (const int edge : cliques.edges(q)) {
            if (edge_alive_[to_index(edge)] != 0) members_.push_back({edge, 0.0, 0.0});
        }
        member_start_.push_back(members_.size());
    }
}

/// Weights of all choices for a new temperature: of each cone and clique, the cheapest one has 1.
bool SmoothedAscent::set_weights(double temperature) {
    const ResidualGraph& r = *residual_;
    set_costs();
    const auto weigh = [&](double& cost, double cheapest) {
        cost = std::exp((cheapest - cost) / temperature);
    };
    for (int a = 0; a < r.size(); ++a) {
        const double at_head = unused_[to_index(r.head[to_index(a)])];
        const double at_tail = unused_[to_index(r.tail[to_index(a)])];
        const int* const out = &r.out_start[to_index(a)];
        const int* const in = &r.in_start[to_index(a)];
        if (clock_.out_of_time(kWorkPerExponential * to_index(out[1] - out[0] + in[1] - in[0] + 2)))
            return false;
        for (int p = out[0]; p < out[1]; ++p) weigh(out_weight_[to_index(p)], at_head);
        for (int p = in[0]; p < in[1]; ++p) weigh(in_weight_[to_index(p)], at_tail);
        weigh(start_weight_[to_index(a)], at_tail);
        weigh(end_weight_[to_index(a)], at_head);
    }
    for (double& unused : unused_) unused = std::exp(unused / temperature);
    in_scale_.assign(cost_.size(), 1.0);
    out_scale_.assign(cost_.size(), 1.0);
    set_choices(temperature);
    return true;
}

/// The cost of each state where its weight will be, and of each cone's cheapest one where `unused_` will be.
void SmoothedAscent::set_costs() {
    const ResidualGraph& r = *residual_;
    unused_.assign(to_index(graph_.cone_count()), 0.0);
    start_weight_.assign(cost_.size(), kUnreachable);
    end_weight_.assign(cost_.size(), kUnreachable);
    out_weight_ = r.out_cost;
    in_weight_ = r.in_cost;
    for (int a = 0; a < r.size(); ++a) {
        const std::size_t at = to_index(a);
        const std::size_t head = to_index(r.head[at]);
        const std::size_t tail = to_index(r.tail[at]);
        for (int p = r.out_start[at]; p < r.out_start[at + 1]; ++p) {
            double& cost = out_weight_[to_index(p)];
            cost += in_price_[at] + out_price_[to_index(r.out_arc[to_index(p)])];
            unused_[head] = std::min(unused_[head], cost);
        }
        for (int p = r.in_start[at]; p < r.in_start[at + 1]; ++p)
            in_weight_[to_index(p)] += in_price_[to_index(r.in_arc[to_index(p)])] + out_price_[at];
        if (system_.kinds[0].start[tail] != 0) start_weight_[at] = out_price_[at] + start_[tail].price;
        if (system_.kinds[0].end[head] != 0) end_weight_[at] = in_price_[at] + end_[head].price;
        unused_[tail] = std::min(unused_[tail], start_weight_[at]);
        unused_[head] = std::min(unused_[head], end_weight_[at]);
    }
}

void SmoothedAscent::set_choices(double temperature) {
    for (auto [cones, choices] : {std::pair(&starts_, &start_), std::pair(&ends_, &end_)}) {
        double most = -kUnreachable;
        for (const int cone : *cones) most = std::max(most, (*choices)[to_index(cone)].price);
        for (const int cone : *cones) {
            Choice& choice = (*choices)[to_index(cone)];
            choice.scale = 1.0;
            choice.weight = std::exp((choice.price - most) / temperature);
        }
    }
    empty_.clear();
    for (std::size_t q = 0; q + 1 < member_start_.size(); ++q) {
        const auto members =
            std::span(members_).subspan(member_start_[q], member_start_[q + 1] - member_start_[q]);
        double most = 0.0;
        for (const Member& member : members) most = std::max(most, member.price);
        empty_.push_back(std::exp(-most / temperature));
        for (Member& member : members) member.weight = std::exp((member.price - most) / temperature);
    }
}

/// Weight of the head's states that come by the arc.
double SmoothedAscent::in_sum(int a) const {
    const ResidualGraph& r = *residual_;
    double sum = end_weight_[to_index(a)] * end_[to_index(r.head[to_index(a)])].scale;
    for (int p = r.out_start[to_index(a)]; p < r.out_start[to_index(a) + 1]; ++p)
        sum += out_weight_[to_index(p)] * out_scale_[to_index(r.out_arc[to_index(p)])];
    return sum * in_scale_[to_index(a)];
}

/// Weight of the tail's states that go on by the arc.
double SmoothedAscent::out_sum(int a) const {
    const ResidualGraph& r = *residual_;
    double sum = start_weight_[to_index(a)] * start_[to_index(r.tail[to_index(a)])].scale;
    for (int p = r.in_start[to_index(a)]; p < r.in_start[to_index(a) + 1]; ++p)
        sum += in_weight_[to_index(p)] * in_scale_[to_index(r.in_arc[to_index(p)])];
    return sum * out_scale_[to_index(a)];
}

bool SmoothedAscent::sweep() {
    const ResidualGraph& r = *residual_;
    if (clock_.out_of_time(kWorkPerTurn * r.out_arc.size() / 2 + 10 * r.arc.size())) return false;
    sum_states();
    for (const int cone : starts_) balance_start(cone);
    for (int k = 0; k < r.size(); ++k) {
        const int a = sweeps_ % 2 == 0 ? k : r.size() - 1 - k;
        const int turns = r.out_start[to_index(a) + 1] - r.out_start[to_index(a)];
        if (clock_.out_of_time(kWorkPerArc + kWorkPerTurn * to_index(turns))) return false;
        balance_arc(a);
    }
    for (int a = 0; a < r.size(); ++a)
        end_[to_index(r.head[to_index(a)])].sum += end_weight_[to_index(a)] * in_scale_[to_index(a)];
    for (const int cone : ends_) {
        if (clock_.out_of_time(kWorkPerArc + graph_.partners(cone).size())) return false;
        balance_end(cone);
    }
    for (std::size_t q = 0; q < empty_.size(); ++q) {
        if (clock_.out_of_time(2 * kWorkPerArc * (member_start_[q + 1] - member_start_[q]))) return false;
        balance_members(q);
    }
    ++sweeps_;
    return true;
}

/// Totals are summed up anew in each sweep, as their changes add up to rounding.
void SmoothedAscent::sum_states() {
    const ResidualGraph& r = *residual_;
    total_ = unused_;
    for (const int cone : starts_) start_[to_index(cone)].sum = 0.0;
    for (const int cone : ends_) end_[to_index(cone)].sum = 0.0;
    for (int a = 0; a < r.size(); ++a) {
        const std::size_t tail = to_index(r.tail[to_index(a)]);
        const double starting = start_weight_[to_index(a)] * out_scale_[to_index(a)];
        total_[to_index(r.head[to_index(a)])] += in_sum(a);
        total_[tail] += starting * start_[tail].scale;
        start_[tail].sum += starting;
    }
    pairs_of_ends_ = 0.0;
    for (const int cone : ends_) {
        for (const int partner : graph_.partners(cone))
            pairs_of_ends_ += 0.5 * end_[to_index(cone)].weight * end_[to_index(partner)].weight;
    }
}

void SmoothedAscent::balance_arc(int a) {
    double& at_head = total_[to_index(residual_->head[to_index(a)])];
    double& at_tail = total_[to_index(residual_->tail[to_index(a)])];
    const double in = in_sum(a);
    const double out = out_sum(a);
    const double scale = balance(in, at_head, out, at_tail);
    in_scale_[to_index(a)] *= scale;
    out_scale_[to_index(a)] /= scale;
    at_head += (scale - 1.0) * in;
    at_tail += (1.0 / scale - 1.0) * out;
}

/// The source chooses two different starts.
void SmoothedAscent::balance_start(int cone) {
    double others = 0.0;
    double squares = 0.0;
    for (const int other : starts_) {
        const double weight = other == cone ? 0.0 : start_[to_index(other)].weight;
        others += weight;
        squares += weight * weight;
    }
    const double chosen = start_[to_index(cone)].weight * others;
    balance_choice(cone, start_[to_index(cone)], chosen,
                   chosen + std::max(0.0, 0.5 * (others * others - squares)));
}

/// The sink chooses two partners.
void SmoothedAscent::balance_end(int cone) {
    double chosen = 0.0;
    for (const int partner : graph_.partners(cone)) chosen += end_[to_index(partner)].weight;
    chosen *= end_[to_index(cone)].weight;
    pairs_of_ends_ += balance_choice(cone, end_[to_index(cone)], chosen, pairs_of_ends_);
}

/// Returns by how much the total of the source, or of the sink, changes.
double SmoothedAscent::balance_choice(int cone, Choice& choice, double chosen, double total) {
    const double in_cone = choice.sum * choice.scale;
    const double scale = balance(in_cone, total_[to_index(cone)], chosen, total);
    choice.scale *= scale;
    choice.weight /= scale;
    total_[to_index(cone)] += (scale - 1.0) * in_cone;
    return (1.0 / scale - 1.0) * chosen;
}

/// Each edge with the cone where one of its arcs comes in and the other one goes out: sweep by sweep, the one
/// at its other end.
void SmoothedAscent::balance_members(std::size_t clique) {
    double in_clique = empty_[clique];
    for (std::size_t k = member_start_[clique]; k < member_start_[clique + 1]; ++k)
        in_clique += members_[k].weight;
    for (std::size_t k = member_start_[clique]; k < member_start_[clique + 1]; ++k) {
        Member& member = members_[k];
        const int in = arcs_of_edge_[to_index(member.edge)][to_index(sweeps_ % 2)];
        const int out = arcs_of_edge_[to_index(member.edge)][to_index(1 - sweeps_ % 2)];
        double& at_cone =
            total_[to_index(in >= 0 ? residual_->head[to_index(in)] : residual_->tail[to_index(out)])];
        const double used = (in >= 0 ? in_sum(in) : 0.0) + (out >= 0 ? out_sum(out) : 0.0);
        const double scale = balance(used, at_cone, member.weight, in_clique);
        if (in >= 0) in_scale_[to_index(in)] *= scale;
        if (out >= 0) out_scale_[to_index(out)] *= scale;
        in_clique += (1.0 / scale - 1.0) * member.weight;
        member.weight /= scale;
        at_cone += (scale - 1.0) * used;
    }
}

/// Prices of what the weights and scales of a stage have become.
void SmoothedAscent::absorb(double temperature) {
    for (std::size_t a = 0; a < cost_.size(); ++a) {
        in_price_[a] -= temperature * std::log(in_scale_[a]);
        out_price_[a] -= temperature * std::log(out_scale_[a]);
    }
    for (const int cone : starts_)
        start_[to_index(cone)].price -= temperature * std::log(start_[to_index(cone)].scale);
    for (const int cone : ends_)
        end_[to_index(cone)].price -= temperature * std::log(end_[to_index(cone)].scale);
    for (std::size_t q = 0; q < empty_.size(); ++q) {
        for (std::size_t k = member_start_[q]; k < member_start_[q + 1]; ++k)
            members_[k].price = temperature * std::log(std::max(members_[k].weight, kMinWeight) / empty_[q]);
    }
}

void SmoothedAscent::separate(CliquePool& cliques) {
    if (cliques.size() >= tuning_.max_cliques) return;
    sum_states();
    edge_use_.assign(to_index(graph_.edge_count()), 0.0);
    for (int a = 0; a < residual_->size(); ++a)
        edge_use_[to_index(residual_->edge(a))] += in_sum(a) / total_[to_index(residual_->head[to_index(a)])];
    separation_.separate(graph_, edge_use_, edge_alive_, tuning_.cliques_per_stage, cliques, clock_);
}

/// The largest price of a clique's edges is one that all of them may have.
bool SmoothedAscent::read(const CliquePool& cliques, Multipliers& multipliers) {
    std::vector<double>& clique = edge_use_;  // scratch from here on
    clique.assign(to_index(cliques.size()), 0.0);
    out_price_ = cost_;
    for (std::size_t q = 0; q + 1 < member_start_.size(); ++q) {
        for (std::size_t k = member_start_[q]; k < member_start_[q + 1]; ++k)
            clique[q] = std::max(clique[q], members_[k].price);
        for (std::size_t k = member_start_[q]; k < member_start_[q + 1]; ++k) {
            for (const int a : arcs_of_edge_[to_index(members_[k].edge)]) {
                if (a >= 0) out_price_[to_index(a)] += clique[q];
            }
        }
    }
    for (std::size_t a = 0; a < cost_.size(); ++a) out_price_[a] -= in_price_[a];
    set_costs();
    const auto is_number = [](double value) { return std::isfinite(value); };
    if (!std::ranges::all_of(unused_, is_number) || !std::ranges::all_of(clique, is_number) ||
        !std::ranges::all_of(out_price_, is_number)) {
        return false;
    }
    multipliers.clique.assign(clique.begin(), clique.end());
    multipliers.cone.clear();
    for (const double cheapest : unused_) multipliers.cone.push_back(0.0 - cheapest);
    return true;
}

}  // namespace conelane::path_pair
