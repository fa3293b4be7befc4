#include "experiments/training/rank_net_training.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/seeded_random.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/training/adam.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>

namespace conelane::experiments {
namespace {

using Generator = boost::random::mt19937_64;

/// Adam's constants as proposed by its authors.
constexpr double kMinDeviation = 1e-8;

/// All candidates, one column each, and the beginning of each list.
struct Candidates {
    Eigen::MatrixXd inputs;
    std::vector<double> quality;      ///< IoU, lowered if the lane diverges or is not usable
    std::vector<std::size_t> begins;  ///< one entry more than lists
};

double penalty(double divergence_m, bool usable, const RankNetTrainingOptions& options) {
    double penalty = usable ? 0.0 : options.unusable_penalty;
    if (divergence_m < kCriticalDivergence_m) {
        penalty += options.divergence_penalty;
    } else if (std::isfinite(divergence_m)) {
        penalty += options.late_divergence_penalty;
    }
    return penalty;
}

Candidates gather(std::span<const CandidateList> lists, const RankNetTrainingOptions& options) {
    const std::size_t inputs = options.inputs;
    Candidates all;
    all.begins.push_back(0);
    for (const CandidateList& list : lists) {
        if (list.lanes.size() < 2) continue;
        all.begins.push_back(all.begins.back() + list.lanes.size());
        for (std::size_t i = 0; i < list.lanes.size(); ++i) {
            all.quality.push_back(list.iou[i] - penalty(list.divergence_m[i], list.usable[i], options));
        }
    }
    if (all.quality.empty()) throw InvalidInput("tracks", "no scene has two candidates to compare");
    all.inputs.resize(static_cast<Eigen::Index>(inputs), static_cast<Eigen::Index>(all.quality.size()));
    Eigen::Index column = 0;
    for (const CandidateList& list : lists) {
        if (list.lanes.size() < 2) continue;
        for (const LaneFeatures& lane : list.lanes) {
            network_inputs(lane, {all.inputs.col(column++).data(), inputs});
        }
    }
    return all;
}

/// Standardises the inputs. Returns mean and deviation; 1 for the deviation of a constant input.
std::pair<Eigen::VectorXd, Eigen::VectorXd> standardise(Eigen::MatrixXd& inputs) {
    const Eigen::VectorXd mean = inputs.rowwise().mean();
    inputs.colwise() -= mean;
    Eigen::VectorXd deviation = inputs.rowwise().squaredNorm() / static_cast<double>(inputs.cols());
    deviation = deviation.cwiseSqrt();
    for (double& value : deviation) {
        if (!(value > 0.0)) value = 1.0;
    }
    inputs.array().colwise() /= deviation.array();
    return {mean, deviation};
}

/// Uniform initial values within +-sqrt(6 / number of inputs) for the hidden layer (He), and +-sqrt(6 /
/// (inputs + outputs)) for the output; biases are 0.
RankNetParameters initial(const RankNetTrainingOptions& options, Generator& random) {
    const auto units = static_cast<Eigen::Index>(options.units);
    const auto inputs = static_cast<Eigen::Index>(options.inputs);
    RankNetParameters parameters{Eigen::MatrixXd(units, inputs), Eigen::VectorXd::Zero(units),
                                 Eigen::VectorXd(units)};
    const auto fill = [&](auto& values, double bound) {
        boost::random::uniform_real_distribution<double> uniform(-bound, bound);
        for (Eigen::Index i = 0; i < values.size(); ++i) values(i) = uniform(random);
    };
    fill(parameters.hidden, std::sqrt(6.0 / static_cast<double>(inputs)));
    fill(parameters.output, std::sqrt(6.0 / static_cast<double>(units + 1)));
    return parameters;
}

Eigen::RowVectorXd scores(const RankNetParameters& parameters, const Eigen::MatrixXd& inputs) {
    constexpr Eigen::Index kBatch = 1024;
    Eigen::RowVectorXd result(inputs.cols());
    for (Eigen::Index first = 0; first < inputs.cols(); first += kBatch) {
        const Eigen::Index count = std::min(kBatch, inputs.cols() - first);
        Eigen::MatrixXd units = parameters.hidden * inputs.middleCols(first, count);
        units.colwise() += parameters.hidden_bias;
        result.segment(first, count).noalias() = parameters.output.transpose() * units.cwiseMax(0.0);
    }
    return result;
}

/// Forward and backward pass of one layer.
struct Pass {
    Eigen::MatrixXd units;
    Eigen::RowVectorXd scores;

    Pass(const RankNetParameters& parameters, const Eigen::MatrixXd& inputs) {
        units.noalias() = parameters.hidden * inputs;
        units.colwise() += parameters.hidden_bias;
        units = units.cwiseMax(0.0);
        scores.noalias() = parameters.output.transpose() * units;
    }
    /// Adds the derivatives, given the derivative of the loss by each score.
    void add_gradient(const RankNetParameters& parameters, const Eigen::MatrixXd& inputs,
                      const Eigen::RowVectorXd& by_score, RankNetParameters& gradient) const {
        gradient.output.noalias() += units * by_score.transpose();
        const Eigen::MatrixXd by_unit =
            ((parameters.output * by_score).array() * (units.array() > 0.0).cast<double>()).matrix();
        gradient.hidden_bias += by_unit.rowwise().sum();
        gradient.hidden.noalias() += by_unit * inputs.transpose();
    }
};

double sigmoid(double value) {
    return 1.0 / (1.0 + std::exp(-value));
}

/// A step of Adam with decoupled weight decay.
class Optimiser {
  public:
    Optimiser(const RankNetParameters& parameters, double weight_decay)
        : weight_decay_(weight_decay),
          hidden_(parameters.hidden.size(), kMinDeviation),
          hidden_bias_(parameters.hidden_bias.size(), kMinDeviation),
          output_(parameters.output.size(), kMinDeviation) {}

    void step(const RankNetParameters& gradient, double learning_rate, RankNetParameters& parameters) {
        parameters.hidden *= 1.0 - learning_rate * weight_decay_;
        parameters.output *= 1.0 - learning_rate * weight_decay_;
        move(hidden_, gradient.hidden, learning_rate, parameters.hidden);
        move(hidden_bias_, gradient.hidden_bias, learning_rate, parameters.hidden_bias);
        move(output_, gradient.output, learning_rate, parameters.output);
    }

  private:
    template <typename Values>
    static void move(Adam& adam, const Values& gradient, double learning_rate, Values& parameters) {
        adam.add(Eigen::Map<const Eigen::ArrayXd>(gradient.data(), gradient.size()));
        Eigen::Map<Eigen::ArrayXd>(parameters.data(), parameters.size()) -=
            learning_rate * adam.mean() / adam.deviation();
    }

    double weight_decay_;
    Adam hidden_;
    Adam hidden_bias_;
    Adam output_;
};

using Pair = std::pair<Eigen::Index, Eigen::Index>;

/// The pairs of an epoch, shuffled.
std::vector<Pair> draw_pairs(const Candidates& all, const RankNetParameters& parameters,
                             const RankNetTrainingOptions& options, Generator& random) {
    const Eigen::RowVectorXd score = scores(parameters, all.inputs);
    boost::random::uniform_01<double> uniform;
    std::vector<Pair> pairs;
    pairs.reserve(all.quality.size());
    for (std::size_t list = 0; list + 1 < all.begins.size(); ++list) {
        const auto begin = static_cast<Eigen::Index>(all.begins[list]);
        const auto size = static_cast<Eigen::Index>(all.begins[list + 1]) - begin;
        Eigen::Index leader = 0;
        score.segment(begin, size).maxCoeff(&leader);
        boost::random::uniform_int_distribution<Eigen::Index> any(0, size - 1);
        for (Eigen::Index first = 0; first < size; ++first) {
            const Eigen::Index second = uniform(random) < options.leader_share ? leader : any(random);
            if (second != first) pairs.emplace_back(begin + first, begin + second);
        }
    }
    shuffle(pairs, random);
    return pairs;
}

/// One epoch. `rate`: the learning rate as a function of the completed share of the epoch.
template <typename Rate>
void train_on_pairs(const Candidates& all, const RankNetTrainingOptions& options, const Rate& rate,
                    Generator& random, Optimiser& optimiser, RankNetParameters& parameters) {
    const std::vector<Pair> pairs = draw_pairs(all, parameters, options, random);
    CandidatePairs batch;
    RankNetParameters gradient;
    for (std::size_t begin = 0; begin < pairs.size(); begin += options.pairs_a_step) {
        const std::size_t count = std::min(options.pairs_a_step, pairs.size() - begin);
        const auto columns = static_cast<Eigen::Index>(count);
        batch.first.resize(all.inputs.rows(), columns);
        batch.second.resize(all.inputs.rows(), columns);
        batch.first_is_better.resize(columns);
        for (Eigen::Index i = 0; i < columns; ++i) {
            const auto [first, second] = pairs[begin + static_cast<std::size_t>(i)];
            batch.first.col(i) = all.inputs.col(first);
            batch.second.col(i) = all.inputs.col(second);
            batch.first_is_better(i) =
                sigmoid(options.iou_factor * (all.quality[static_cast<std::size_t>(first)] -
                                              all.quality[static_cast<std::size_t>(second)]));
        }
        (void)pair_loss(parameters, batch, &gradient);
        optimiser.step(gradient, rate(static_cast<double>(begin) / static_cast<double>(pairs.size())),
                       parameters);
    }
}

/// One epoch: every scene once, in random order.
template <typename Rate>
void train_on_scenes(const Candidates& all, const RankNetTrainingOptions& options, const Rate& rate,
                     Generator& random, Optimiser& optimiser, RankNetParameters& parameters) {
    std::vector<std::size_t> order(all.begins.size() - 1);
    std::iota(order.begin(), order.end(), std::size_t{0});
    shuffle(order, random);
    CandidateScenes batch;
    RankNetParameters gradient;
    for (std::size_t begin = 0; begin < order.size(); begin += options.scenes_a_step) {
        const std::span<const std::size_t> drawn =
            std::span(order).subspan(begin, std::min(options.scenes_a_step, order.size() - begin));
        batch.begins.assign(1, 0);
        for (const std::size_t list : drawn) {
            batch.begins.push_back(batch.begins.back() +
                                   static_cast<Eigen::Index>(all.begins[list + 1] - all.begins[list]));
        }
        batch.inputs.resize(all.inputs.rows(), batch.begins.back());
        batch.quality.resize(batch.begins.back());
        for (std::size_t i = 0; i < drawn.size(); ++i) {
            const auto from = static_cast<Eigen::Index>(all.begins[drawn[i]]);
            const Eigen::Index size = batch.begins[i + 1] - batch.begins[i];
            batch.inputs.middleCols(batch.begins[i], size) = all.inputs.middleCols(from, size);
            batch.quality.segment(batch.begins[i], size) =
                Eigen::Map<const Eigen::RowVectorXd>(all.quality.data() + from, size);
        }
        (void)choice_loss(parameters, batch, &gradient);
        optimiser.step(gradient, rate(static_cast<double>(begin) / static_cast<double>(order.size())),
                       parameters);
    }
}

void validate(const RankNetTrainingOptions& options) {
    const auto require = [](bool valid, const char* key, const char* reason) {
        if (!valid) throw InvalidInput(key, reason);
    };
    require(options.inputs == kPaperFeatureCount || options.inputs == kLaneFeatureCount, "inputs",
            "must be the paper's features or all");
    require(options.units > 0, "units", "must be positive");
    require(options.epochs > 0, "epochs", "must be positive");
    require(options.pairs_a_step > 0, "pairs_a_step", "must be positive");
    require(options.scenes_a_step > 0, "scenes_a_step", "must be positive");
    require(std::isfinite(options.learning_rate) && options.learning_rate > 0.0, "learning_rate",
            "must be positive");
    require(options.weight_decay >= 0.0 && options.weight_decay * options.learning_rate < 1.0, "weight_decay",
            "must not be negative, and its product with the learning rate below 1");
    require(std::isfinite(options.iou_factor) && options.iou_factor > 0.0, "iou_factor", "must be positive");
    require(options.divergence_penalty >= 0.0 && std::isfinite(options.divergence_penalty),
            "divergence_penalty", "must not be negative");
    require(options.late_divergence_penalty >= 0.0 && std::isfinite(options.late_divergence_penalty),
            "late_divergence_penalty", "must not be negative");
    require(options.unusable_penalty >= 0.0 && std::isfinite(options.unusable_penalty), "unusable_penalty",
            "must not be negative");
    require(options.leader_share >= 0.0 && options.leader_share <= 1.0, "leader_share", "must be in [0, 1]");
}

}  // namespace

double pair_loss(const RankNetParameters& parameters, const CandidatePairs& pairs,
                 RankNetParameters* gradient) {
    const Pass first(parameters, pairs.first);
    const Pass second(parameters, pairs.second);
    const auto count = static_cast<double>(pairs.first.cols());
    const Eigen::RowVectorXd difference = first.scores - second.scores;
    double loss = 0.0;
    for (Eigen::Index i = 0; i < difference.size(); ++i) {
        // -p log(sigmoid(d)) - (1 - p) log(1 - sigmoid(d)), in a form that does not overflow.
        const double d = difference(i);
        loss += std::max(d, 0.0) - pairs.first_is_better(i) * d + std::log1p(std::exp(-std::abs(d)));
    }
    if (gradient != nullptr) {
        const Eigen::RowVectorXd by_score = (difference.unaryExpr(&sigmoid) - pairs.first_is_better) / count;
        *gradient = {parameters.hidden * 0.0, parameters.hidden_bias * 0.0, parameters.output * 0.0};
        first.add_gradient(parameters, pairs.first, by_score, *gradient);
        second.add_gradient(parameters, pairs.second, -by_score, *gradient);
    }
    return loss / count;
}

double choice_loss(const RankNetParameters& parameters, const CandidateScenes& scenes,
                   RankNetParameters* gradient) {
    const Pass pass(parameters, scenes.inputs);
    const auto scene_count = static_cast<double>(scenes.begins.size() - 1);
    Eigen::RowVectorXd by_score(pass.scores.size());
    double loss = 0.0;
    for (std::size_t i = 0; i + 1 < scenes.begins.size(); ++i) {
        const Eigen::Index begin = scenes.begins[i];
        const Eigen::Index size = scenes.begins[i + 1] - begin;
        const auto score = pass.scores.segment(begin, size).array();
        const auto quality = scenes.quality.segment(begin, size).array();
        // Shifted so that nothing overflows.
        Eigen::RowVectorXd probability = (score - score.maxCoeff()).exp();
        probability /= probability.sum();
        const double expected = (probability.array() * quality).sum();
        loss -= expected;
        by_score.segment(begin, size) = probability.array() * (expected - quality) / scene_count;
    }
    if (gradient != nullptr) {
        *gradient = {parameters.hidden * 0.0, parameters.hidden_bias * 0.0, parameters.output * 0.0};
        pass.add_gradient(parameters, scenes.inputs, by_score, *gradient);
    }
    return loss / scene_count;
}

RankNetWeights train_rank_net(std::span<const CandidateList> lists, const RankNetTrainingOptions& options) {
    validate(options);
    Candidates all = gather(lists, options);
    const auto [mean, deviation] = standardise(all.inputs);
    Generator random(options.seed);
    RankNetParameters parameters = initial(options, random);
    Optimiser optimiser(parameters, options.weight_decay);
    Progress progress("training", options.show_progress ? options.epochs : 0);
    for (std::size_t epoch = 0; epoch < options.epochs; ++epoch) {
        // The rate falls along a cosine from the first step to the last.
        const auto rate = [&](double share_of_epoch) {
            const double done =
                (static_cast<double>(epoch) + share_of_epoch) / static_cast<double>(options.epochs);
            return cosine_rate(options.learning_rate, done);
        };
        if (options.loss == RankLoss::pairs) {
            train_on_pairs(all, options, rate, random, optimiser, parameters);
        } else {
            train_on_scenes(all, options, rate, random, optimiser, parameters);
        }
        progress.advance();
    }
    return {mean,
            deviation,
            parameters.hidden.cast<float>(),
            parameters.hidden_bias.cast<float>(),
            parameters.output.cast<float>(),
            0.0F};
}

RankingFigures ranking_figures(std::span<const CandidateList> lists, const LaneRanking& ranking) {
    RankingFigures figures;
    std::vector<double> scores;
    for (const CandidateList& list : lists) {
        scores.resize(list.lanes.size());
        ranking.score(list.lanes, scores);
        double divergence_m = 0.0;
        if (!scores.empty()) {
            const auto chosen = static_cast<std::size_t>(std::ranges::max_element(scores) - scores.begin());
            figures.mean_iou += list.iou[chosen];
            divergence_m = list.divergence_m[chosen];
            if (list.usable[chosen]) figures.usable_share += 1.0;
        }
        if (std::ranges::find(list.usable, true) != list.usable.end()) figures.most_usable_share += 1.0;
        const auto is_critical = [](double distance_m) { return distance_m < kCriticalDivergence_m; };
        if (is_critical(divergence_m)) figures.critical_share += 1.0;
        if (std::ranges::all_of(list.divergence_m, is_critical)) figures.least_critical_share += 1.0;
        figures.mean_best_iou += list.best_iou();
        if (list.best_iou() >= kNearGroundTruthIou) figures.near_best_share += 1.0;
    }
    figures.scenes = lists.size();
    if (lists.empty()) return figures;
    const auto count = static_cast<double>(lists.size());
    figures.mean_iou /= count;
    figures.mean_best_iou /= count;
    figures.near_best_share /= count;
    figures.usable_share /= count;
    figures.most_usable_share /= count;
    figures.critical_share /= count;
    figures.least_critical_share /= count;
    return figures;
}

}  // namespace conelane::experiments
