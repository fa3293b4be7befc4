#include "evaluation/formats/figure_file.hpp"

#include "evaluation/formats/json_node.hpp"

#include <utility>

namespace conelane {

void FigureFile::add(nlohmann::ordered_json figures) {
    figures["commit"] = origin_.commit;
    figures["compiler"] = origin_.compiler;
    figures["machine"] = origin_.machine;
    output_.stream() << to_line(figures) << '\n';
}

}  // namespace conelane
