#include "tests/support/test_paths.hpp"

namespace conelane {

std::filesystem::path source_directory() {
    return CONELANE_SOURCE_DIR;
}

std::string conelane_program() {
    return CONELANE_PROGRAM;
}

std::string outside_child() {
    return CONELANE_OUTSIDE_CHILD;
}

std::string solver_child() {
    return CONELANE_SOLVER_CHILD;
}

std::string clc_stream() {
    return CONELANE_EXAMPLE;
}

}  // namespace conelane
