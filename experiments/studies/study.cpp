#include "experiments/studies/study.hpp"

#include "experiments/studies/anytime.hpp"
#include "experiments/studies/backends.hpp"
#include "experiments/studies/confidence_and_colour.hpp"
#include "experiments/studies/deadlines.hpp"
#include "experiments/studies/features.hpp"
#include "experiments/studies/formulations.hpp"
#include "experiments/studies/front_beam.hpp"
#include "experiments/studies/growth.hpp"
#include "experiments/studies/memory.hpp"
#include "experiments/studies/noise.hpp"
#include "experiments/studies/optimality.hpp"
#include "experiments/studies/relaxations.hpp"

namespace conelane::experiments {

std::vector<std::unique_ptr<Study>> make_studies() {
    std::vector<std::unique_ptr<Study>> studies;
    studies.push_back(make_optimality_study());
    studies.push_back(make_backends_study());
    studies.push_back(make_anytime_study());
    studies.push_back(make_growth_study());
    studies.push_back(make_features_study());
    studies.push_back(make_formulations_study());
    studies.push_back(make_relaxations_study());
    studies.push_back(make_confidence_and_color_study());
    studies.push_back(make_front_beam_study());
    studies.push_back(make_deadlines_study());
    studies.push_back(make_memory_study());
    studies.push_back(make_noise_study());
    return studies;
}

}  // namespace conelane::experiments
