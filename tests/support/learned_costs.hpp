#pragma once

#include "conelane/learned_costs.hpp"
#include "tests/support/testing.hpp"

namespace conelane::tests {

/// Any weights between -0.6 and 0.6, but edges that gain 1 more, and 2 more for 3 m over a gap.
inline std::shared_ptr<const LearnedCosts> random_learned_costs(std::uint64_t seed, std::size_t units) {
    boost::random::mt19937_64 random(seed);
    boost::random::uniform_real_distribution<double> any(-0.6, 0.6);
    LearnedCosts costs = LearnedCosts::zero(units);
    for (LearnedNetwork& network : costs.networks) {
        for (std::vector<double>* list : {&network.linear, &network.hidden, &network.output}) {
            for (double& number : *list) number = any(random);
        }
    }
    costs.of(LearnedPart::edge).linear[0] -= 1.0;
    costs.of(LearnedPart::edge).linear[5] -= 2.0;
    return std::make_shared<const LearnedCosts>(costs);
}

}  // namespace conelane::tests
