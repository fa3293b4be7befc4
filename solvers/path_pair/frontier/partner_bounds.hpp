#pragma once

#include "solvers/path_pair/bound/pair_relaxation.hpp"

namespace conelane::path_pair {

/// What two legs cost on from their last arcs at least, if their ends have to be partners (17): by arc and
/// end, the cheapest walk on to the end and the cheapest one to any partner of it. Only ends below a limit
/// count.
class PartnerBounds {
  public:
    /// Returns false, and must not be used, if the clock expired. `limit`: with offset. Precondition: the
    /// relaxation was evaluated on the residual graph, both legs are alike, and ends are partners.
    bool find(const PairRelaxation& relaxation, const ResidualGraph& residual, double limit,
              SearchClock& clock);

    /// Of two legs that both go on or end.
    [[nodiscard]] double onward(int arc, int other_arc) const;
    /// Of the leg on from `arc` if the other one has ended with `ended_arc`.
    [[nodiscard]] double onward_to_partner(int arc, int ended_arc) const;

  private:
    void find_ends(const PairRelaxation& relaxation, const ResidualGraph& residual, double limit);
    bool find_walks(const PairRelaxation& relaxation, const ResidualGraph& residual, SearchClock& clock);
    bool find_partners(const PairRelaxation& relaxation, const ResidualGraph& residual, SearchClock& clock);
    [[nodiscard]] const double* to_ends(int arc) const {
        return to_end_.data() + to_index(arc) * ends_.size();
    }
    [[nodiscard]] const double* to_partners(int arc) const {
        return to_partner_.data() + to_index(arc) * ends_.size();
    }

    std::vector<int> ends_;        ///< cones
    std::vector<int> end_of_arc_;  ///< number of the end at its head; -1 if a leg must not end with it
    std::vector<double> to_end_;   ///< by arc and end
    std::vector<double> to_partner_;

    // Scratch.
    std::vector<int> end_at_;  ///< by cone
    std::vector<int> changed_;
};

}  // namespace conelane::path_pair
