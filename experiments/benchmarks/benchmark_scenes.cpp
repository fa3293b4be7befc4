#include "experiments/benchmarks/benchmark_scenes.hpp"

#include "evaluation/formats/scene_file.hpp"
#include "evaluation/world/generated_tracks.hpp"
#include "evaluation/world/scene_generation.hpp"

#include <cstdlib>
#include <exception>
#include <iostream>
#include <iterator>

#include <benchmark/benchmark.h>

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

int run_benchmarks(int argument_count, char** arguments, double false_positive_rate,
                   const std::function<void(const SharedScenes&)>& register_all) {
    benchmark::Initialize(&argument_count, arguments);
    if (benchmark::ReportUnrecognizedArguments(argument_count, arguments)) return 1;
    try {
        register_all(
            std::make_shared<const std::vector<AnnotatedScene>>(benchmark_scenes(false_positive_rate)));
    } catch (const std::exception& failure) {
        std::cerr << arguments[0] << ": " << failure.what() << '\n';
        return 2;
    }
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}

}  // namespace conelane::experiments
