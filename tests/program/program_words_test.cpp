// Messages of the program about a wrong word of the command line or a wrong key of a file: they name the
// word, and what would be right.

#include "evaluation/formats/json_node.hpp"
#include "tests/support/program_on_scenes.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

using testing::HasSubstr;
using testing::Not;

class Words : public Program {};

TEST_F(Words, AListWithAnEmptyPartIsRefused) {
    for (const char* option : {"--fp", "--range", "--condition"}) {
        for (const char* list : {",", "0,", ",0", "0,,0.3"}) {
            const std::string begin =
                std::string("scenes --tracks generated:circle --out s.scenes.jsonl ") + option;
            for (const char* between : {" ", "="}) {
                expect_refused(begin + between + list,
                               {std::string(option) + ": '" + list + "' is a list with an empty part"});
            }
            // The following word is not part of the list.
            expect_refused(std::string("scenes --tracks generated:circle ") + option + " " + list +
                               " --out s.scenes.jsonl",
                           {option, "empty part"});
        }
    }
    expect_refused("sweep --sizes , --out r", {"--sizes: ',' is a list with an empty part"});
}

TEST_F(Words, ACountThatIsNotAWholeNumberIsRefused) {
    for (const char* count : {"2.5", "0", "-1", "many", "100001", "99999999999999999999", "12x"}) {
        expect_refused(
            "scenes --tracks generated:circle --out s.scenes.jsonl --nearest=" + std::string(count),
            {"--nearest: '" + std::string(count) + "' is not a whole number from 1 to 100000"});
    }
    expect_refused("sweep --sizes 6,2.5 --out r", {"--sizes: '2.5' is not a whole number from 1 to 100000"});
    expect_refused("compare --threads 2.5 --out r",
                   {"--threads: '2.5' is not a whole number from 1 to 1024"});
    expect_refused("train --tracks generated:circle --epochs 2.5 --out w.json", {"--epochs: '2.5'"});
    expect_refused("study growth --scenes s.scenes.jsonl --sizes 2.5", {"--sizes: '2.5'"});
}

TEST_F(Words, AValueBehindAnOptionOfOtherValuesIsRefused) {
    for (const char* between :
         {"--warm-start", "--limit 3", "--limit=3", "--sizes 12", "--formulations tight"}) {
        const std::string option = std::string(between).substr(0, std::string(between).find_first_of(" ="));
        expect_refused("study backends --scenes s.scenes.jsonl --solvers path-pair " + std::string(between) +
                           " exec:mine=./mine",
                       {option + ": does not take 'exec:mine=./mine'", "directly behind its name"});
    }
    expect_refused("compare --methods clc --tracks generated:circle exec:a=b --out r",
                   {"--tracks: does not take 'exec:a=b'"});
}

TEST_F(Words, AFolderThatIsMissingIsNamed) {
    expect_refused("study formulations --scenes s.scenes.jsonl --out none/such.jsonl",
                   {"--out: none/such.jsonl: cannot be written", "make the folder 'none' first"});
}

TEST_F(Words, AnUnknownCommandListsTheCommands) {
    expect_refused("study nope", {"study: there is no 'nope'", "optimality", "front-beam", "noise"});
    expect_refused("study nope --scenes s.scenes.jsonl --out x", {"study: there is no 'nope'", "optimality"});
    expect_refused("nope", {"there is no 'nope'", "compare", "solve"});
    expect_refused("train fornt --tracks generated:circle --out w", {"train: there is no 'fornt'", "front"});
}

TEST_F(Words, HelpOfTrainSaysWhatItTrains) {
    const Outcome help = run("train --help");
    EXPECT_THAT(help.output.substr(0, help.output.find("Usage")), HasSubstr("train front"));
    EXPECT_THAT(run("--help").output, HasSubstr("train front"));
}

/// The commands that a help text lists, each as the words that call it.
std::vector<std::string> commands_in(const std::string& help, const std::string& before) {
    std::vector<std::string> commands;
    const std::set<std::string> heads{"Subcommands:", "Detect:", "Compare:", "Solve:", "Learn:", "Drive:"};
    std::istringstream lines(help);
    bool is_listed = false;
    for (std::string line; std::getline(lines, line);) {
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
        std::istringstream lines(help.output);
        for (std::string line; std::getline(lines, line);) {
            EXPECT_LE(line.size(), 100U) << commands[i] << "--help: " << line;
            EXPECT_FALSE(line.ends_with(' ')) << commands[i] << "--help: " << line;
        }
        for (const std::string& below : commands_in(help.output, commands[i])) commands.push_back(below);
    }
    EXPECT_GT(commands.size(), 30U) << "the commands, the studies and train front";
    EXPECT_THAT(commands, testing::IsSupersetOf({"compare ", "study cross-check ", "train front "}));
    EXPECT_LE(commands_in(run("--help").output, "").size(), 18U);
}

/// Progress is shown on a terminal on stderr; files, pipes and standard output get none.
TEST_F(Words, LongWorkSaysOnATerminalHowMuchTimeIsLeft) {
    if (std::system("script -qec true /dev/null >/dev/null 2>&1 </dev/null") != 0)
        GTEST_SKIP() << "no program `script`, or no terminals for it (/dev/pts)";
    const std::string scenes = "scenes --tracks generated:long_lap --fp 0,0.1,0.3,0.5 --every 0.15 --out ";
    const std::string within = "cd " + path("").string() + " && ";
    const std::string on_terminal = within + "script -qec '" + conelane_program() + " " + scenes +
                                    "a.scenes.jsonl >said' typescript >/dev/null </dev/null";
    ASSERT_EQ(std::system(on_terminal.c_str()), 0);
    const std::string drawn = text_of(path("typescript"));
    EXPECT_THAT(drawn, HasSubstr("scenes ["));
    EXPECT_THAT(drawn, HasSubstr(" s left"));
    const Outcome quiet = run_well(scenes + "b.scenes.jsonl");
    EXPECT_EQ(quiet.errors, "");
    EXPECT_THAT(text_of(path("said")), testing::EndsWith("in a.scenes.jsonl, boundaries in a.tracks.json\n"));
    EXPECT_EQ(text_of(path("said")).size(), quiet.output.size()) << "a bar among the output";
    EXPECT_EQ(text_of(path("a.scenes.jsonl")), text_of(path("b.scenes.jsonl")));
}

TEST_F(Words, AKeyThatIsThereTwiceIsNamedWithItsLine) {
    file_with(std::string(kScene) + "\n" +
                  R"({"id": "b", "pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [{"id": 1, "x": 1, "y": 2}, )"
                  R"({"id": 2, "x": 4, "y": 2, "x": 9}]})" +
                  "\n",
              "s.scenes.jsonl");
    expect_refused("detect --method clc --scenes s.scenes.jsonl --out l.lanes.jsonl",
                   {"s.scenes.jsonl:2: cones[1].x: is there twice"});
    // Also for keys that are not read: it is unknown which of the two is right.
    file_with(R"({"note": {"a": [1, {"b": 1}, {"b": 2, "b": 3}]}})"
              "\n",
              "s.scenes.jsonl");
    expect_refused("detect --method clc --scenes s.scenes.jsonl --out l.lanes.jsonl",
                   {"s.scenes.jsonl:1: note.a[2].b: is there twice"});
    file_with(std::string(kScene) + "\n", "s.scenes.jsonl");
    file_with("{\n  \"w_bb\": 1,\n  \"pairing\": \"paper\",\n  \"w_bb\": 2\n}\n", "p.json");
    expect_refused("solve --scenes s.scenes.jsonl --params p.json --out o.solutions.jsonl",
                   {"p.json:4: w_bb: is there twice"});
    const Outcome streamed = run("detect --method clc --scenes - --out - <p.json");
    EXPECT_THAT(streamed.output, Not(HasSubstr("\"status\":\"found\"")));
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
