#include "learning/training/rank_net_training.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/progress/progress.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/seeded_random.hpp"
#include "learning/training/training_loop.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>

namespace conelane::learning {
namespace {

using Generator = boost::random::mt19937_64;

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

CandidatePairs batch_of(const Candidates& all, std::span<const Pair> pairs, double iou_factor) {
    CandidatePairs batch;
    const auto columns = static_cast<Eigen::Index>(pairs.size());
    batch.first.resize(all.inputs.rows(), columns);
    batch.second.resize(all.inputs.rows(), columns);
    batch.first_is_better.resize(columns);
    for (Eigen::Index i = 0; i < columns; ++i) {
        const auto [first, second] = pairs[static_cast<std::size_t>(i)];
        batch.first.col(i) = all.inputs.col(first);
        batch.second.col(i) = all.inputs.col(second);
        batch.first_is_better(i) = sigmoid(iou_factor * (all.quality[static_cast<std::size_t>(first)] -
                                                         all.quality[static_cast<std::size_t>(second)]));
    }
    return batch;
}

CandidateScenes batch_of(const Candidates& all, std::span<const std::size_t> lists) {
    CandidateScenes batch;
    batch.begins.assign(1, 0);
    for (const std::size_t list : lists) {
        batch.begins.push_back(batch.begins.back() +
                               static_cast<Eigen::Index>(all.begins[list + 1] - all.begins[list]));
    }
    batch.inputs.resize(all.inputs.rows(), batch.begins.back());
    batch.quality.resize(batch.begins.back());
    for (std::size_t i = 0; i < lists.size(); ++i) {
        const auto from = static_cast<Eigen::Index>(all.begins[lists[i]]);
        const Eigen::Index size = batch.begins[i + 1] - batch.begins[i];
        batch.inputs.middleCols(batch.begins[i], size) = all.inputs.middleCols(from, size);
        batch.quality.segment(batch.begins[i], size) =
            Eigen::Map<const Eigen::RowVectorXd>(all.quality.data() + from, size);
    }
    return batch;
}

class RankNetTraining : public GradientLearner {
  public:
    RankNetTraining(const Candidates& all, const RankNetTrainingOptions& options)
        : all_(all),
          options_(options),
          random_(options.seed),
          parameters_(initial(options, random_)),
          progress_("training", options.show_progress ? options.epochs : 0) {}

    [[nodiscard]] const RankNetParameters& parameters() const { return parameters_; }
    void set_values(const Eigen::ArrayXd& values) override { set(parameters_, values); }
    [[nodiscard]] bool is_done(std::size_t /*steps*/) const override { return epoch_ == options_.epochs; }

    /// A batch of pairs, or of scenes. In an epoch, each one comes once, in random order.
    [[nodiscard]] Step step(std::size_t /*number*/) override {
        const bool of_pairs = options_.loss == RankLoss::pairs;
        if (begin_ == 0) begin_epoch(of_pairs);
        const std::size_t size = of_pairs ? pairs_.size() : order_.size();
        const std::size_t count =
            std::min(of_pairs ? options_.pairs_a_step : options_.scenes_a_step, size - begin_);
        Step result;
        if (count > 0) {
            RankNetParameters gradient;
            if (of_pairs) {
                (void)pair_loss(parameters_,
                                batch_of(all_, std::span(pairs_).subspan(begin_, count), options_.iou_factor),
                                &gradient);
            } else {
                (void)choice_loss(parameters_, batch_of(all_, std::span(order_).subspan(begin_, count)),
                                  &gradient);
            }
            const double share_of_epoch = static_cast<double>(begin_) / static_cast<double>(size);
            const double done =
                (static_cast<double>(epoch_) + share_of_epoch) / static_cast<double>(options_.epochs);
            result = {flat(gradient), cosine_rate(options_.learning_rate, done)};
        }
        begin_ += count;
        if (begin_ == size) {
            begin_ = 0;
            ++epoch_;
            progress_.advance();
        }
        return result;
    }

    /// With decoupled weight decay.
    void move(const Adam& adam, double rate, Eigen::ArrayXd& values) const override {
        values.head(parameters_.hidden.size()) *= 1.0 - rate * options_.weight_decay;
        values.tail(parameters_.output.size()) *= 1.0 - rate * options_.weight_decay;
        GradientLearner::move(adam, rate, values);
    }

  private:
    void begin_epoch(bool of_pairs) {
        if (of_pairs) {
            pairs_ = draw_pairs(all_, parameters_, options_, random_);
            return;
        }
        order_.resize(all_.begins.size() - 1);
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        shuffle(order_, random_);
    }

    const Candidates& all_;
    const RankNetTrainingOptions& options_;
    Generator random_;
    RankNetParameters parameters_;
    std::size_t epoch_ = 0;
    std::size_t begin_ = 0;  ///< of the next batch, in the pairs or the order of the epoch
    std::vector<Pair> pairs_;
    std::vector<std::size_t> order_;
    Progress progress_;
};

void validate(const RankNetTrainingOptions& options) {
    if (options.inputs != kPaperFeatureCount && options.inputs != kLaneFeatureCount)
        throw InvalidInput("inputs", "must be the paper's features or all");
    RankNetTrainingOptions copy = options;
    require_in_range(option_fields(copy));
    if (options.weight_decay * options.learning_rate >= 1.0)
        throw InvalidInput("--decay", "times --rate must be below 1");
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

OptionFields option_fields(RankNetTrainingOptions& options) {
    return {{"--units", "units", &options.units, kCount, "number of units of the hidden layer"},
            {"", "loss", options.loss == RankLoss::pairs ? "pairs" : "choice"},
            {"--epochs", "epochs", &options.epochs, kCount, "rounds over the candidates"},
            {"", "pairs_a_step", &options.pairs_a_step, kCount},
            {"--scenes-a-step", "scenes_a_step", &options.scenes_a_step, kCount,
             "scenes to a step of Adam, with --extended"},
            {"--rate", "learning_rate", &options.learning_rate, kPositive, "learning rate of Adam"},
            {"--decay", "weight_decay", &options.weight_decay, kNotNegative,
             "decay of the network's weights by each step, times the rate"},
            {"--iou-factor", "iou_factor", &options.iou_factor, kPositive, "lambda_iou of equation (14)"},
            {"--divergence-penalty", "divergence_penalty", &options.divergence_penalty, kNotNegative,
             "subtracted from the IoU of a lane that leaves the true one within 20 m; 0 in the paper"},
            {"--late-divergence-penalty", "late_divergence_penalty", &options.late_divergence_penalty,
             kNotNegative, "subtracted for a lane that leaves it later"},
            {"--unusable-penalty", "unusable_penalty", &options.unusable_penalty, kNotNegative,
             "also subtracted if a lane is not usable: wrong or too short"},
            {"--leader-share", "leader_share", &options.leader_share, kShare,
             "share of the pairs that hold the candidate ranked first so far"},
            {"", "seed", &options.seed}};
}

RankNetWeights train_rank_net(std::span<const CandidateList> lists, const RankNetTrainingOptions& options) {
    validate(options);
    Candidates all = gather(lists, options);
    const auto [mean, deviation] = standardise(all.inputs);
    RankNetTraining training(all, options);
    learn(training, flat(training.parameters()), {});
    const RankNetParameters& parameters = training.parameters();
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
    divide_by_scenes(figures);
    return figures;
}

}  // namespace conelane::learning
