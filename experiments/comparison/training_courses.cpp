#include "experiments/comparison/training_courses.hpp"

#include "experiments/comparison/known_detectors.hpp"

#include <algorithm>

namespace conelane::experiments {

std::set<std::string> training_courses(std::string_view detector) {
    const auto known = std::ranges::find(known_detectors(), detector, &KnownDetector::name);
    if (known == known_detectors().end()) return {};
    std::set<std::string> courses(known->learned_from.courses().begin(), known->learned_from.courses().end());
    for (const std::string_view weights : known->learned_from.weights()) {
        const std::set<std::string>& of_weights = courses_of_weights().at(std::string(weights));
        courses.insert(of_weights.begin(), of_weights.end());
    }
    return courses;
}

}  // namespace conelane::experiments
