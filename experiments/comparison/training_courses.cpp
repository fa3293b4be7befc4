#include "experiments/comparison/training_courses.hpp"

#include "experiments/comparison/methods.hpp"

#include <algorithm>

namespace conelane::experiments {

std::set<std::string> training_courses(std::string_view method) {
    const auto known = std::ranges::find(methods(), method, &Method::name);
    if (known == methods().end()) return {};
    std::set<std::string> courses(known->learned_from.courses().begin(), known->learned_from.courses().end());
    for (const std::string_view weights : known->learned_from.weights()) {
        const std::set<std::string>& of_weights = courses_of_weights().at(std::string(weights));
        courses.insert(of_weights.begin(), of_weights.end());
    }
    return courses;
}

}  // namespace conelane::experiments
