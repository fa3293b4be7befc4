// Messages of the program about a wrong word of the command line or a wrong key of a file: they name the
// word, and what would be right.

#include "evaluation/formats/json_node.hpp"
#include "tests/support/program_on_scenes.hpp"

namespace conelane::experiments {
namespace {

class Words : public Program {};

/// The commands that a help text lists, each as the words that call it.
std::vector<std::string> commands_in(const std::vector<std::string>& lines, const std::string& before) {
    std::vector<std::string> commands;
    const std::set<std::string> heads{"Subcommands:", "Detect:", "Compare:", "Solve:", "Learn:", "Drive:"};
    bool is_listed = false;
    for (const std::string& line : lines) {
        if (line.ends_with(':')) is_listed = heads.contains(line);
        if (!is_listed || line.size() < 3 || !line.starts_with("  ") || line[2] == ' ') continue;
        commands.push_back(before + line.substr(2, line.find(' ', 2) - 2) + ' ');
    }
    return commands;
}

TEST_F(Words, HelpOfEveryCommandFitsAHundredColumns) {
    std::vector<std::string> commands{""};
    for (std::size_t i = 0; i < commands.size(); ++i) {
        const Outcome help = run(commands[i] + "--help");
        ASSERT_EQ(help.exit_code, 0) << commands[i];
        const std::vector<std::string> lines = lines_of(help.output);
        for (const std::string& line : lines) {
            EXPECT_LE(line.size(), 100U) << commands[i] << "--help: " << line;
            EXPECT_FALSE(line.ends_with(' ')) << commands[i] << "--help: " << line;
        }
        for (const std::string& below : commands_in(lines, commands[i])) commands.push_back(below);
    }
    EXPECT_GT(commands.size(), 25U) << "the commands, the studies and train front";
    EXPECT_THAT(commands, testing::IsSupersetOf({"compare ", "study cross-check ", "train front "}));
    EXPECT_LE(commands_in(lines_of(run("--help").output), "").size(), 18U);
}

/// The values are those of nlohmann's own parser.
TEST_F(Words, AnyOtherJsonIsReadAsItWas) {
    for (const char* text :
         {R"({})", R"({"a": [], "b": {}, "c": null, "d": true, "e": false})",
          R"({"a": -1, "b": 18446744073709551615, "c": 1.5e-3, "d": "x\n\u00e9"})",
          R"({"a": [[1, 2], [{"b": [3, {"c": 4}]}], "s"], "d": {"a": {"a": {"a": 1}}}})"}) {
        with_json_text(text, "file", [&](const JsonNode& read) {
            const nlohmann::json expected = nlohmann::json::parse(text);
            for (const std::string& key : read.keys()) EXPECT_TRUE(expected.contains(key)) << key;
            EXPECT_EQ(read.keys().size(), expected.size());
        });
    }
    with_json_text(R"({"a": [[1, 2], [{"b": [3, {"c": 4}]}], "s"], "d": {"a": {"a": {"a": 7}}}})", "file",
                   [&](const JsonNode& read) {
                       const JsonNode a = read.member("a");
                       ASSERT_EQ(a.array_size(), 3U);
                       EXPECT_EQ(a.element(0).element(1).integer(), 2);
                       const JsonNode b = a.element(1).element(0).member("b");
                       EXPECT_EQ(b.element(0).integer(), 3);
                       EXPECT_EQ(b.element(1).member("c").integer(), 4);
                       EXPECT_EQ(a.element(2).string(), "s");
                       EXPECT_EQ(read.member("d").member("a").member("a").member("a").integer(), 7);
                   });
}

}  // namespace
}  // namespace conelane::experiments
