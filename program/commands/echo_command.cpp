#include "program/commands/commands.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace conelane::experiments {
namespace {

/// Only the id is read, which is first in each question: parsing JSON, or std::cin, would take longer than
/// the round trip itself.
void echo() {
    constexpr std::string_view kBegin = R"({"id":")";
    char* buffer = nullptr;
    std::size_t capacity = 0;
    for (ssize_t length = 0; (length = ::getline(&buffer, &capacity, stdin)) > 0;) {
        const std::string_view line(buffer, static_cast<std::size_t>(length));
        if (!line.starts_with(kBegin)) continue;  // a reset
        const std::string_view rest = line.substr(kBegin.size());
        const std::string id(rest.substr(0, rest.find('"')));
        std::printf(R"({"scene":"%s","status":"none"})"
                    "\n",
                    id.c_str());
        std::fflush(stdout);
    }
    std::free(buffer);
}

}  // namespace

void add_echo_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("echo",
                                "reads scenes from standard input, in the protocol of programs from outside, "
                                "and answers each at once with status none: measures the round trip");
    command.callback(echo);
}

}  // namespace conelane::experiments
