#include "tests/support/test_paths.hpp"

#include <fstream>
#include <iterator>

namespace conelane {

std::filesystem::path source_directory() {
    return CONELANE_SOURCE_DIR;
}

std::string source_text(const std::string& file) {
    std::ifstream stream(source_directory() / file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
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
