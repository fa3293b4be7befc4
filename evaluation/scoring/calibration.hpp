#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace conelane {

/// How far what a detector says of its own lanes holds. Shares are in [0, 1], and absent where nothing
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

    /// A lane said to be usable with that probability. Precondition: in [0, 1].
    void add(double confidence, bool is_usable);
    /// A lane of that length that is said to be right up to `trusted_m`, and leaves the true boundaries at
    /// `divergence_m`, if at all.
    void add_trust(double trusted_m, double lane_length_m, std::optional<double> divergence_m);

    /// By confidence, from [0, 0.1) to [0.9, 1].
    [[nodiscard]] const std::array<Bin, kBins>& bins() const { return bins_; }
    /// Expected calibration error: mean over the lanes of |confidence - share usable| of their bin.
    [[nodiscard]] std::optional<double> error() const;
    /// Of the lanes with a confidence of kSure at least, the share that is usable.
    [[nodiscard]] std::optional<double> usable_where_sure() const;
    /// Of all lanes, those with a confidence of kSure at least.
    [[nodiscard]] std::optional<double> sure() const;
    /// Share of the lanes that are right up to their trusted length.
    [[nodiscard]] std::optional<double> right_where_trusted() const;
    /// Trusted lengths of all lanes together, as a share of their lengths.
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
