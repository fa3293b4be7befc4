#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace conelane::experiments {

/// Turns scores into probabilities in place; returns the logarithm of the sum of exponentials. Precondition:
/// at least one score.
template <typename Number>
double to_probabilities(std::vector<Number>& scores) {
    const double highest = *std::ranges::max_element(scores);
    double sum = 0.0;
    for (Number& score : scores) {
        score = static_cast<Number>(std::exp(static_cast<double>(score) - highest));
        sum += static_cast<double>(score);
    }
    for (Number& score : scores) score = static_cast<Number>(static_cast<double>(score) / sum);
    return highest + std::log(sum);
}

}  // namespace conelane::experiments
