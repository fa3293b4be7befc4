#include "learning/training/cost_training.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/seeded_random.hpp"

#include <boost/random/normal_distribution.hpp>

namespace conelane::learning {

void add_gradient(const LearnedNetwork& network, std::span<const double> features, double factor,
                  LearnedNetwork& gradient) {
    const std::size_t units = network.units();
    for (std::size_t i = 0; i < features.size(); ++i) gradient.linear[i] += factor * features[i];
    for (std::size_t u = 0; u < units; ++u) {
        double sum = 0.0;
        for (std::size_t i = 0; i < features.size(); ++i) sum += network.hidden[i * units + u] * features[i];
        if (sum <= 0.0) continue;
        gradient.output[u] += factor * sum;
        for (std::size_t i = 0; i < features.size(); ++i)
            gradient.hidden[i * units + u] += factor * network.output[u] * features[i];
    }
}

void add_hidden_units(std::span<LearnedNetwork> networks, std::size_t units, std::uint64_t seed) {
    auto random = generator_of("learned costs", seed);
    for (LearnedNetwork& network : networks) {
        std::vector<double> linear = std::move(network.linear);
        network = LearnedNetwork::zero(linear.size(), units);
        network.linear = std::move(linear);
        if (units == 0) continue;
        boost::random::normal_distribution<double> of_hidden(
            0.0, std::sqrt(2.0 / static_cast<double>(network.linear.size())));
        for (double& number : network.hidden) number = of_hidden(random);
        boost::random::normal_distribution<double> of_output(0.0,
                                                             0.02 / std::sqrt(static_cast<double>(units)));
        for (double& number : network.output) number = of_output(random);
    }
}

OptionFields cost_fields(CostTrainingOptions& options, const OptionFields& own) {
    OptionFields fields = draw_fields(options, false);
    const OptionFields shared{
        {"--units",
         "units",
         &options.units,
         {0.0, 256.0},
         "hidden units of each network; 0 for linear costs, a readable weight a feature"},
        {"--steps", "steps", &options.steps, kCountOrNone, "steps of Adam"},
        {"--rate", "learning_rate", &options.learning_rate, kPositive, "learning rate, which falls to 0"}};
    fields.insert(fields.end(), shared.begin(), shared.end());
    fields.insert(fields.end(), own.begin(), own.end());
    const OptionFields run = run_fields(options, "--report-every");
    fields.insert(fields.end(), run.begin(), run.end());
    return fields;
}

void require_units(std::span<const LearnedNetwork> networks, std::size_t units) {
    for (const LearnedNetwork& network : networks) {
        if (network.units() != 0 && network.units() != units)
            throw InvalidInput("--units", "must be those of the costs that the training begins with");
    }
}

}  // namespace conelane::learning
