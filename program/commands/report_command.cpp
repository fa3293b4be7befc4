#include "experiments/options/shared_options.hpp"
#include "experiments/report/package.hpp"
#include "experiments/report/report.hpp"
#include "program/commands/commands.hpp"

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane::experiments {
namespace {

struct ReportOptions {
    std::string results;
    std::string page;
    std::string pictures;
    std::string python;
    std::vector<std::string> viewer;
};

void make_report(const ReportOptions& options) {
    try {
        write_report(options.results, options.page, options.pictures, options.python,
                     fmt::format("{}", fmt::join(options.viewer, ",")));
    } catch (const PackageRefused&) {
        throw CLI::RuntimeError(2);  // it has printed the reason
    }
    fmt::print("the page is {}\n", options.page);
}

}  // namespace

void add_report_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("report", "one HTML page from stored results");
    auto options = std::make_shared<ReportOptions>();
    command.add_option("--results", options->results, "directory that `conelane compare` wrote")->required();
    add_output_option(command, "--out", options->page, "PAGE.html")->required();
    command.add_option("--png", options->pictures, "folder for the main figures as PNG too");
    command.add_option("--python", options->python, "interpreter that has matplotlib; python3 without it");
    command
        .add_option("--viewer", options->viewer,
                    "tracks whose laps the scene viewer has; without it as many laps as fit, first those on "
                    "which the methods fail most")
        ->delimiter(',');
    command.callback([options] { make_report(*options); });
}

}  // namespace conelane::experiments
