#include "experiments/benchmarks/benchmark_scenes.hpp"

#include "evaluation/formats/scene_file.hpp"
#include "evaluation/world/generated_tracks.hpp"
#include "evaluation/world/scene_generation.hpp"

#include <cstdlib>
#include <iterator>
#include <string>
#include <utility>

namespace conelane::experiments {

std::vector<AnnotatedScene> benchmark_scenes(double false_positive_rate) {
    if (const char* file = std::getenv("CONELANE_SCENES")) return read_scenes(file);
    SceneOptions options;
    options.false_positive_rates = {false_positive_rate};
    options.ranges_m = {30.0};
    options.every_m = 15.0;
    std::vector<AnnotatedScene> all;
    for (const std::string& name : generated_track_names()) {
        std::vector<AnnotatedScene> scenes = generate_scenes(generate_track(name, 0), options);
        std::move(scenes.begin(), scenes.end(), std::back_inserter(all));
    }
    return all;
}

std::vector<Scene> scenes_of_size(const std::vector<AnnotatedScene>& all, std::size_t size) {
    std::vector<Scene> scenes;
    for (const AnnotatedScene& annotated : all) {
        Scene scene = nearest_ahead(annotated.scene, size);
        if (scene.cones.size() == size) scenes.push_back(std::move(scene));
    }
    return scenes;
}

}  // namespace conelane::experiments
