#pragma once

#include "graph_search/front/front_cost.hpp"
#include "tests/support/testing.hpp"

#include <boost/random/normal_distribution.hpp>

namespace conelane::tests {

/// Weights that judge moves at random.
inline FrontWeights random_front_weights(std::uint64_t seed) {
    boost::random::mt19937_64 random(seed);
    FrontWeights weights = FrontWeights::zero();
    for (FrontNetworkWeights* network : {&weights.extend, &weights.stop, &weights.start}) {
        boost::random::normal_distribution<float> any(0.0F, 0.3F);
        for (std::vector<float>* numbers :
             {&network->hidden, &network->hidden_bias, &network->output, &network->linear}) {
            for (float& number : *numbers) number = any(random);
        }
        network->output_bias = any(random);
    }
    return weights;
}

/// A network with weights at random, without a bias of its output.
inline FrontNetworkWeights random_front_network(std::size_t inputs, std::uint64_t seed) {
    boost::random::mt19937_64 random(seed);
    boost::random::normal_distribution<float> any(0.0F, 0.3F);
    FrontNetworkWeights network = FrontNetworkWeights::zero(inputs);
    for (std::vector<float>* numbers :
         {&network.hidden, &network.hidden_bias, &network.output, &network.linear})
        for (float& number : *numbers) number = any(random);
    return network;
}

/// A straight lane of width 3.6 m ahead of a car at the origin, a cone every 4 m from x = 2: left ids 0, 1,
/// ..., right ids 100, 101, ...
inline Scene straight_front_scene(int cones_a_side) {
    Scene scene;
    for (int i = 0; i < cones_a_side; ++i) {
        scene.cones.push_back({i, {2.0 + 4.0 * i, 1.8}});
        scene.cones.push_back({100 + i, {2.2 + 4.0 * i, -1.8}});
    }
    return scene;
}

}  // namespace conelane::tests
