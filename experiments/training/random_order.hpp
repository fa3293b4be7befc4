#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_int_distribution.hpp>

namespace conelane::experiments {

/// Shuffles: the same order from the same generator with any standard library.
template <typename Value>
void shuffle(std::vector<Value>& values, boost::random::mt19937_64& random) {
    for (std::size_t i = values.size(); i > 1; --i) {
        std::swap(values[i - 1],
                  values[boost::random::uniform_int_distribution<std::size_t>(0, i - 1)(random)]);
    }
}

}  // namespace conelane::experiments
