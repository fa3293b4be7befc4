#include "program/commands/page.hpp"

#include "experiments/report/report.hpp"

#include <exception>

#include <fmt/format.h>

namespace conelane::experiments {

void write_page(const std::filesystem::path& directory) {
    const std::filesystem::path page = directory / "report.html";
    try {
        write_report(directory, page);
        fmt::print("all of it in {}, as a page in {}\n", directory.string(), page.string());
    } catch (const std::exception& failure) {
        fmt::print("all of it in {}; no page: {}\n", directory.string(), failure.what());
    }
}

}  // namespace conelane::experiments
