#include "program/commands/page.hpp"

#include "evaluation/input_error.hpp"
#include "experiments/report/package.hpp"
#include "experiments/report/report.hpp"

#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

fs::path page_in(const fs::path& directory) {
    return directory / "report.html";
}

}  // namespace

void require_own_page(const fs::path& directory) {
    // The mark that report/page.py writes near the beginning.
    constexpr std::string_view kTitle = "<title>conelane: ";
    constexpr std::size_t kBeginning = 2000;
    const fs::path page = page_in(directory);
    std::error_code ignored;
    if (!fs::is_regular_file(page, ignored) || fs::file_size(page, ignored) == 0) return;
    std::string beginning(kBeginning, ' ');
    std::ifstream(page, std::ios::binary).read(beginning.data(), kBeginning);
    if (beginning.find(kTitle) != std::string::npos) return;
    throw InputError(page, 0, "",
                     "is not a page of conelane and would be replaced; move it, or name another directory");
}

void say_wide_table(const fs::path& directory) {
    fmt::print("wide table: {}\n", (directory / "table.txt").string());
}

void write_page(const fs::path& directory) {
    const fs::path page = page_in(directory);
    try {
        write_report(directory, page);
    } catch (const NoPython& missing) {
        fmt::print("results: {}, without a page: {}\n", directory.string(), missing.what());
        return;
    } catch (const PackageRefused&) {
        fmt::print("results: {}, without a page\n", directory.string());
        constexpr int kFailed = 2;
        throw CLI::RuntimeError(kFailed);  // it has printed the reason
    } catch (const std::exception&) {
        fmt::print("results: {}, without a page\n", directory.string());
        throw;
    }
    fmt::print("results: {}, page: {}\n", directory.string(), page.string());
}

}  // namespace conelane::experiments
