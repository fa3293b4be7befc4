#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace conelane {

/// Whether a detector's statements about its own lanes are true. Shares are in [0, 1], and absent if no lane
/// counts.
class Calibration {
  public:
    static constexpr std::size_t kBins = 10;
    static constexpr double kSure = 0.99;

    struct Bin {
        std::size_t lanes = 0;
        double confidence = 0.0;  ///< sum
        std::size_t usable = 0;
    };

    /// Counts a lane with this probability of being usable. Precondition: it is in [0, 1].
    void add(double confidence, bool is_usable);
    /// Counts a lane of that length, which is said to be right up to `trusted_m`, and which leaves the true
    /// boundaries at `divergence_m`, if at all.
    void add_trust(double trusted_m, double lane_length_m, std::optional<double> divergence_m);

    /// By confidence, from [0, 0.1) to [0.9, 1].
    [[nodiscard]] const std::array<Bin, kBins>& bins() const { return bins_; }
    /// Expected calibration error: mean over the lanes of |confidence - share usable| of their bin.
    [[nodiscard]] std::optional<double> error() const;
    /// Share of usable lanes among those with a confidence of at least kSure.
    [[nodiscard]] std::optional<double> usable_where_sure() const;
    /// Share of lanes with a confidence of at least kSure.
    [[nodiscard]] std::optional<double> sure() const;
    /// Share of the lanes that are right up to their trusted length.
    [[nodiscard]] std::optional<double> right_where_trusted() const;
    /// Sum of the trusted lengths over the sum of the lengths.
    [[nodiscard]] std::optional<double> trusted_share() const;

  private:
    std::array<Bin, kBins> bins_{};
    std::size_t lanes_ = 0;
    std::size_t sure_ = 0;
    std::size_t usable_where_sure_ = 0;
    std::size_t with_trust_ = 0;
    std::size_t right_where_trusted_ = 0;
    double trusted_m_ = 0.0;
    double length_m_ = 0.0;
};

}  // namespace conelane
