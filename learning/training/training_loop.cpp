#include "learning/training/training_loop.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"

#include <type_traits>

#include <fmt/format.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::learning {
namespace {

bool is_in(double value, const OptionRange& range) {
    return value <= range.most && (range.is_open ? value > range.least : value >= range.least) &&
           (std::isfinite(value) || (!std::isnan(value) && range.least < 0.0));
}

bool is_valid(const OptionField& field) {
    return std::visit(
        [&](const auto& value) {
            using Value = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<Value, std::array<std::size_t, 2>*> ||
                          std::is_same_v<Value, std::array<double, 2>*>) {
                const auto [low, high] = *value;
                return is_in(static_cast<double>(low), field.range) &&
                       is_in(static_cast<double>(high), field.range) && low <= high;
            } else if constexpr (std::is_arithmetic_v<std::remove_pointer_t<Value>>) {
                return is_in(static_cast<double>(*value), field.range);
            }
            return true;
        },
        field.value);
}

std::string reason(const OptionRange& range) {
    if (std::isfinite(range.most))
        return fmt::format("must be in {}{}, {}]", range.is_open ? "(" : "[", range.least, range.most);
    return fmt::format("must be {} {}", range.is_open ? "above" : "at least", range.least);
}

constexpr int kVersion = 1;  // of checkpoints

struct Checkpoint {
    std::size_t step = 0;  ///< steps done
    Eigen::ArrayXd values;
    Adam::State adam;
};

Eigen::ArrayXd array(const JsonNode& node, Eigen::Index size) {
    if (node.array_size() != static_cast<std::size_t>(size))
        node.fail("must have " + std::to_string(size) + " numbers");
    Eigen::ArrayXd result(size);
    for (Eigen::Index i = 0; i < size; ++i) result[i] = node.element(static_cast<std::size_t>(i)).number();
    return result;
}

Checkpoint read_checkpoint(const LearningLoop& loop, Eigen::Index size) {
    Checkpoint checkpoint;
    with_json_file(loop.checkpoint, [&](const JsonNode& node) {
        if (node.member("version").integer() != kVersion)
            node.member("version").fail("must be " + std::to_string(kVersion));
        if (node.member("training").string() != loop.identity)
            node.member("training").fail("is another training than the one asked for");
        checkpoint = {node.member("step").unsigned_integer(),
                      array(node.member("values"), size),
                      {array(node.member("first"), size), array(node.member("second"), size),
                       node.member("first_power").number(), node.member("second_power").number()}};
    });
    return checkpoint;
}

void write_checkpoint(const LearningLoop& loop, std::size_t step, const Eigen::ArrayXd& values,
                      const Adam::State& adam) {
    const auto numbers = [](const Eigen::ArrayXd& of) { return std::vector<double>(of.begin(), of.end()); };
    const nlohmann::ordered_json json{{"version", kVersion},
                                      {"training", loop.identity},
                                      {"step", step},
                                      {"values", numbers(values)},
                                      {"first", numbers(adam.first)},
                                      {"second", numbers(adam.second)},
                                      {"first_power", adam.first_power},
                                      {"second_power", adam.second_power}};
    AtomicFile output(loop.checkpoint);
    output.stream() << json.dump() << '\n';
    output.commit();
}

}  // namespace

void require_in_range(const OptionFields& fields) {
    for (const OptionField& field : fields) {
        if (!is_valid(field))
            throw InvalidInput(*field.option != '\0' ? field.option : field.key, reason(field.range));
    }
}

nlohmann::ordered_json record_of(const OptionFields& fields) {
    nlohmann::ordered_json record = nlohmann::ordered_json::object();
    for (const OptionField& field : fields) {
        const std::string key = field.key;
        if (key.empty()) continue;
        const std::size_t dot = key.find('.');
        auto& place =
            dot == std::string::npos ? record[key] : record[key.substr(0, dot)][key.substr(dot + 1)];
        std::visit(
            [&](const auto& value) {
                if constexpr (std::is_same_v<std::decay_t<decltype(value)>, const char*>) {
                    place = value;
                } else {
                    place = *value;
                }
            },
            field.value);
    }
    return record;
}

void Adam::add(const Eigen::Ref<const Eigen::ArrayXd>& derivatives) {
    constexpr double kFirstDecay = 0.9;
    constexpr double kSecondDecay = 0.999;
    state_.first_power *= kFirstDecay;
    state_.second_power *= kSecondDecay;
    state_.first = kFirstDecay * state_.first + (1.0 - kFirstDecay) * derivatives;
    state_.second = kSecondDecay * state_.second + (1.0 - kSecondDecay) * derivatives * derivatives;
}

Eigen::ArrayXd limited_mean(const Eigen::ArrayXd& sum, double count, double most) {
    Eigen::ArrayXd mean = sum / count;
    const double length = std::sqrt(mean.square().sum());
    if (length > most) mean *= most / length;
    return mean;
}

void learn(GradientLearner& learner, Eigen::ArrayXd values, const LearningLoop& loop) {
    oneapi::tbb::task_arena arena(
        std::min(static_cast<int>(loop.threads), oneapi::tbb::info::default_concurrency()));
    const auto finish = [&] { arena.execute([&] { learner.finish(); }); };
    Adam adam(values.size(), loop.smallest_deviation);
    std::size_t steps = 0;
    if (!loop.checkpoint.empty() && std::filesystem::exists(loop.checkpoint)) {
        Checkpoint checkpoint = read_checkpoint(loop, values.size());
        steps = checkpoint.step;
        values = checkpoint.values;
        adam.restore(std::move(checkpoint.adam));
        learner.set_values(values);
    }
    if (learner.is_done(steps)) {
        finish();
        if (loop.report_every > 0) learner.report(steps);
    }
    while (!learner.is_done(steps)) {
        if (learner.begins_stage(steps)) adam = Adam(values.size(), loop.smallest_deviation);
        const GradientLearner::Step step = arena.execute([&] { return learner.step(steps); });
        ++steps;
        if (step.derivatives.size() > 0) {
            adam.add(step.derivatives);
            learner.move(adam, step.rate, values);
            learner.set_values(values);
        }
        const bool is_last = learner.is_done(steps);
        if (is_last) finish();
        if (!loop.checkpoint.empty() && (is_last || steps % loop.checkpoint_every == 0))
            write_checkpoint(loop, steps, values, adam.state());
        if (loop.report_every > 0 && (is_last || steps % loop.report_every == 0)) learner.report(steps);
    }
}

}  // namespace conelane::learning
