#pragma once

#include <algorithm>

namespace conelane {

/// Count, sum and sum of squares of numbers.
struct Moments {
    double count = 0.0;
    double sum = 0.0;
    double sum_of_squares = 0.0;

    void add(double value) {
        count += 1.0;
        sum += value;
        sum_of_squares += value * value;
    }
    /// Mean, mean of squares and variance are 0 if nothing was added.
    [[nodiscard]] double mean() const { return count == 0.0 ? 0.0 : sum / count; }
    [[nodiscard]] double mean_of_squares() const { return count == 0.0 ? 0.0 : sum_of_squares / count; }
    [[nodiscard]] double variance() const { return std::max(0.0, mean_of_squares() - mean() * mean()); }
};

}  // namespace conelane
