#include "experiments/comparison/training_courses.hpp"

namespace conelane::experiments {

std::set<std::string> training_courses(std::string_view method) {
    std::set<std::string> courses;
    const auto add = [&courses](const char* weights) {
        const std::set<std::string>& of_weights = courses_of_weights().at(weights);
        courses.insert(of_weights.begin(), of_weights.end());
    };
    if (method == "front" || method == "front-warm") {
        add("front");
    } else if (method == "clc-paper" || method == "clc-delaunay") {
        add("rank_net_paper");
    } else if (method.starts_with("clc") && method != "clc-longest") {
        add("rank_net_extended");
        if (method != "clc-no-beam") add("step_scores");
    } else if (method.starts_with("rld-shape")) {
        // Its costs were set by hand with these in view.
        courses = {"fsd_1", "fsd_2", "fsd_4", "fsd_5", "fsd_6", "fsd_7", "fsd_9"};
    } else if (method == "delaunay-beam" || method == "astar-lane") {
        // Those of the records beside their parameters.
        courses = {"fsd_1", "fsd_4",        "fsd_5",        "fsd_7",
                   "fsd_9", "pacsim_FSE22", "pacsim_FSG19", "eufs_small_track"};
        // That hitting a cone has a cost was decided with these in view.
        if (method == "astar-lane")
            courses.merge(std::set<std::string>{"fsd_2", "fsd_6", "pacsim_FSO20", "eufs_peanut"});
    }
    return courses;
}

}  // namespace conelane::experiments
