#pragma once

#include "solvers/path_pair/bound/multipliers.hpp"

#include <utility>
#include <vector>

namespace conelane::path_pair {

/// The multipliers of an ascent that a certificate repeats: multiples of a unit, and only those that dropped
/// something, in order.
class MultiplierStages {
  public:
    explicit MultiplierStages(double unit) : unit_(unit) {}

    /// Rounds the multipliers that are evaluated next. No arc gets cheaper, so no cycle gains.
    void round(Multipliers& multipliers);
    /// The multipliers rounded last dropped something.
    void keep() { stages_.push_back(evaluated_); }
    void add(const Multipliers& multipliers) { stages_.push_back(multipliers); }
    [[nodiscard]] std::vector<Multipliers> take() { return std::exchange(stages_, {}); }

  private:
    double unit_;
    Multipliers evaluated_;
    std::vector<Multipliers> stages_;
};

}  // namespace conelane::path_pair
