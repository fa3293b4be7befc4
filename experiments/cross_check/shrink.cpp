#include "experiments/cross_check/drawn_case.hpp"

#include <algorithm>
#include <utility>

namespace conelane::experiments {
namespace {

class Shrinking {
  public:
    Shrinking(CrossCheckCase drawn, const std::function<bool(const CrossCheckCase&)>& differs,
              std::size_t max_trials)
        : smallest_(std::move(drawn)), differs_(differs), trials_left_(max_trials) {}

    CrossCheckCase run() {
        for (std::size_t together = smallest_.scene.cones.size() / 2; together > 1; together /= 2)
            (void)remove_cones(together);
        while (remove_cones(1)) {
        }
        reset_parameters();
        while (remove_cones(1)) {  // simpler parameters may need fewer cones
        }
        return std::move(smallest_);
    }

  private:
    bool keeps_differing(CrossCheckCase smaller) {
        if (trials_left_ == 0) return false;
        --trials_left_;
        if (!differs_(smaller)) return false;
        smallest_ = std::move(smaller);
        return true;
    }

    /// Tries to remove each run of so many cones. Returns whether one was removed.
    bool remove_cones(std::size_t together) {
        bool any = false;
        for (std::size_t first = 0; first < smallest_.scene.cones.size();) {
            CrossCheckCase smaller = smallest_;
            std::vector<Cone>& cones = smaller.scene.cones;
            const std::size_t count = std::min(together, cones.size() - first);
            const auto begin = cones.begin() + static_cast<std::ptrdiff_t>(first);
            cones.erase(begin, begin + static_cast<std::ptrdiff_t>(count));
            if (!cones.empty() && keeps_differing(std::move(smaller))) {
                any = true;
            } else {
                first += count;
            }
        }
        return any;
    }

    void reset_parameters() {
        const auto reset = [&](auto member) {
            if (smallest_.parameters.*member == RldParameters{}.*member) return;
            CrossCheckCase simpler = smallest_;
            simpler.parameters.*member = RldParameters{}.*member;
            (void)keeps_differing(std::move(simpler));
        };
        for (const auto& fields : {rld_extra_fields(), rld_parameter_fields()}) {
            for (const RldParameterField& field : fields) reset(field.value);
        }
        reset(&RldParameters::use_confidence);
        reset(&RldParameters::forbid_crossing);
        reset(&RldParameters::pairing);
        reset(&RldParameters::learned_costs);
    }

    CrossCheckCase smallest_;
    const std::function<bool(const CrossCheckCase&)>& differs_;
    std::size_t trials_left_;
};

}  // namespace

CrossCheckCase shrink(CrossCheckCase drawn, const std::function<bool(const CrossCheckCase&)>& differs,
                      std::size_t max_trials) {
    return Shrinking(std::move(drawn), differs, max_trials).run();
}

}  // namespace conelane::experiments
