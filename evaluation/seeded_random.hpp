#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/seed_seq.hpp>
#include <boost/random/uniform_int_distribution.hpp>

namespace conelane {

/// The generator of random numbers for the scene or track of that name.
inline boost::random::mt19937_64 generator_of(const std::string& name, std::uint64_t seed) {
    std::vector<std::uint32_t> words{static_cast<std::uint32_t>(seed),
                                     static_cast<std::uint32_t>(seed >> 32U)};
    for (const char letter : name) words.push_back(static_cast<unsigned char>(letter));
    boost::random::seed_seq sequence(words.begin(), words.end());
    return boost::random::mt19937_64(sequence);
}

/// Fisher and Yates. The same order from the same generator with any standard library; std::shuffle does not
/// guarantee this.
template <typename Value>
void shuffle(std::vector<Value>& values, boost::random::mt19937_64& random) {
    for (std::size_t i = values.size(); i > 1; --i) {
        std::swap(values[i - 1],
                  values[boost::random::uniform_int_distribution<std::size_t>(0, i - 1)(random)]);
    }
}

}  // namespace conelane
