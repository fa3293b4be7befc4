#pragma once

#include "model/strip_problem.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane::tests {

/// Weights at random, but metres of boundary that gain and turns that cost.
inline std::shared_ptr<const StripCosts> random_strip_costs(std::uint64_t seed, std::size_t units = 0) {
    boost::random::mt19937_64 random(seed);
    boost::random::uniform_real_distribution<double> any(-0.3, 0.3);
    StripCosts costs = StripCosts::zero(units);
    for (LearnedNetwork& network : costs.networks) {
        for (std::vector<double>* list : {&network.linear, &network.hidden, &network.output}) {
            for (double& number : *list) number = any(random);
        }
    }
    costs.of(StripPart::edge).linear[1] -= 1.5;
    costs.of(StripPart::triangle).linear[1] += 1.0;
    costs.of(StripPart::turn).linear[2] += 1.5;
    return std::make_shared<const StripCosts>(costs);
}

/// Limits below those of a car, so that backends are quick.
inline StripParameters random_strip_parameters(std::uint64_t seed, std::size_t units = 0) {
    StripParameters parameters = driving_strip_parameters();
    parameters.gates.s_crit = 7.0;
    parameters.gates.d_gap = 11.0;
    parameters.gates.nearest_of_edge = 8.0;
    parameters.w_max_m = 8.5;
    parameters.costs = random_strip_costs(seed, units);
    return parameters;
}

/// RLD without the constraints that the strip program does not have.
inline RldParameters rld_without_width_and_heading() {
    RldParameters parameters;
    parameters.d_min = 0.0;
    parameters.d_h = 1000.0;
    parameters.theta_heading = std::numbers::pi / 2.0;
    return parameters;
}

}  // namespace conelane::tests
