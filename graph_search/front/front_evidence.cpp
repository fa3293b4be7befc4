#include "graph_search/front/front_evidence.hpp"

#include "conelane/invalid_input.hpp"

#include <algorithm>
#include <cmath>

namespace conelane {

FrontEvidence::FrontEvidence(double bonus) : bonus_(bonus) {
    if (!(bonus >= 0.0 && std::isfinite(bonus))) throw InvalidInput("repeat_bonus", "must be at least 0");
}

void FrontEvidence::remember(const Lane& lane) {
    remembered_.clear();
    for (const ConeId id : lane.left) remembered_.emplace_back(id, bit_of(kLeft));
    for (const ConeId id : lane.right) remembered_.emplace_back(id, bit_of(kRight));
    std::ranges::sort(remembered_);
}

void FrontEvidence::find_again(const Scene& scene, const FrontMap& map) {
    sides_.assign(map.size(), 0);
    if (remembered_.empty()) return;
    for (Vertex cone = 0; cone < map.size(); ++cone) {
        const ConeId id = scene.cones[map.scene_index(cone)].id;
        const auto known =
            std::ranges::lower_bound(remembered_, id, {}, &std::pair<ConeId, std::uint8_t>::first);
        if (known != remembered_.end() && known->first == id) sides_[cone] = known->second;
    }
}

}  // namespace conelane
