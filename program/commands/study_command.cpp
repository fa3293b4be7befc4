#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/provenance.hpp"
#include "experiments/studies/study.hpp"
#include "program/commands/command_parts.hpp"
#include "program/commands/commands.hpp"

namespace conelane::program {
namespace {

struct StudyOptions {
    std::vector<std::unique_ptr<Study>> studies = make_studies();
    std::string out;
};

void run(Study& study, const std::string& out) {
    StudyResult result = study.run();
    if (!out.empty()) {
        AtomicFile output(out);
        const Provenance origin = provenance();
        for (nlohmann::ordered_json& row : result.rows) {
            row["commit"] = origin.commit;
            row["compiler"] = origin.compiler;
            row["machine"] = origin.machine;
            output.stream() << to_line(row) << '\n';
        }
        output.commit();
    }
    fmt::print("{}", result.table);
    report_errors(result.errors);
}

void list(const std::vector<std::unique_ptr<Study>>& studies) {
    for (const auto& study : studies) {
        fmt::print("{:<22} {}\n", study->description().name, study->description().question);
    }
    fmt::print("{:<22} {}\n", "cross-check",
               "do all exact solvers agree with each other and with the checker?");
}

}  // namespace

void add_study_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("study", "measures one question; without a name it lists the questions");
    command.require_subcommand(0, 1);
    auto options = std::make_shared<StudyOptions>();
    for (const auto& study : options->studies) {
        const StudyDescription& description = study->description();
        const std::string name(description.name);
        CLI::App& one = *command.add_subcommand(name, std::string(description.question));
        one.footer("Protocol: " + std::string(description.protocol));
        study->add_options(one);
        add_output_option(one, "--out", options->out, "write the rows as JSON lines too");
        one.callback([options, &measured = *study] { run(measured, options->out); });
    }
    add_cross_check_command(command);
    command.callback([options, &command] {
        if (command.get_subcommands().empty()) list(options->studies);
    });
}

}  // namespace conelane::program
