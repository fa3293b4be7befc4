// What command lines of the program end by, and what their files hold: the tables *.txt beside this file.

#include "tests/support/program_fixture.hpp"
#include "tests/support/recorded_tracks.hpp"
#include "tests/support/text_tables.hpp"

namespace conelane::experiments {
namespace {

using tests::replaced;
using tests::split;

/// The lines of a section, one after another, in a folder of their own.
class TableLines : public ProgramFixture, public testing::WithParamInterface<tests::TableSection> {
  protected:
    void SetUp() override {
        ProgramFixture::SetUp();
        const std::string folder = std::filesystem::path(conelane_program()).parent_path();
        const std::map<const char*, std::string> variables{{"PATH", folder + ":" + std::getenv("PATH")},
                                                           {"DATA", recorded_data()},
                                                           {"SOURCE", source_directory()},
                                                           {"CHILD", outside_child()},
                                                           {"SOLVER", solver_child()},
                                                           {"STREAM", clc_stream()}};
        for (const auto& [name, value] : variables) ::setenv(name, value.c_str(), 1);
    }
    [[nodiscard]] bool in_shell(const std::string& command) const {
        return std::system(("cd " + path("").string() + " && " + command).c_str()) == 0;
    }
    void make_file(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories(path(name).parent_path());
        file_with(text.empty() ? "" : replaced(text.substr(1), "\\n", "\n") + "\n", name);
    }
    /// Whether the line of this form is one of the table: `FILE has WORD ; WORD`, or `lacks`.
    [[nodiscard]] bool holds(const std::string& line, const std::string& verb) const {
        const std::vector<std::string> parts = split(line, verb);
        if (parts.size() != 2 || parts[0].find(' ') != std::string::npos) return false;
        EXPECT_TRUE(std::filesystem::exists(path(parts[0]))) << line;
        for (const std::string& word : split(parts[1], " ; "))
            EXPECT_EQ(text_of(path(parts[0])).find(word) != std::string::npos, verb == " has ")
                << line << word;
        return true;
    }
    void expect_command(const std::string& line) {
        if (const std::size_t begin = line.find("[["); begin != std::string::npos) {
            const std::size_t end = line.find("]]", begin);
            for (const std::string& choice : split(line.substr(begin + 2, end - begin - 2), "|"))
                expect_command(line.substr(0, begin) + choice +
                               replaced(line.substr(end + 2), "[[]]", choice));
            return;
        }
        if (line.starts_with("$ ")) return static_cast<void>(run_well(line.substr(2)));
        if (line.starts_with("! ")) {
            EXPECT_TRUE(in_shell(line.substr(2))) << line;
            return;
        }
        for (const auto& [arrow, exit_code] : {std::pair{" => ", 2}, {" =0> ", 0}, {" =1> ", 1}}) {
            const std::vector<std::string> parts = split(line, arrow);
            if (parts.size() != 2) continue;
            const std::vector<std::string> words = split(parts[1], " ; ");
            exit_code == 2 ? expect_refused(parts[0], words) : expect_end(parts[0], exit_code, words);
            return;
        }
        FAIL() << line;
    }
    void expect_lines() {
        std::size_t checked = 0;
        std::vector<std::string> file;
        for (const std::string& line : GetParam().lines) {
            if (line.starts_with("? ")) {
                if (!in_shell(line.substr(2) + " >/dev/null 2>&1 </dev/null")) GTEST_SKIP() << line;
            } else if (line.starts_with("| ")) {
                std::ofstream(path(file.at(0)), std::ios::app) << line.substr(2) << '\n';
            } else if (const std::vector<std::string> made = split(line, " <-"); made.size() == 2) {
                file = made;
                make_file(file[0], file[1]);
            } else {
                ++checked;
                if (!holds(line, " has ") && !holds(line, " lacks ")) expect_command(line);
            }
        }
        EXPECT_GT(checked, 0U);
    }
};

class CommandLines : public TableLines {
  protected:
    void SetUp() override {
        TableLines::SetUp();
        ::setenv("PYTHONHOME", "nowhere", 1);  // pages would take most of the time here
    }
    void TearDown() override {
        ::unsetenv("PYTHONHOME");
        TableLines::TearDown();
    }
};
TEST_P(CommandLines, EndAsTheTableSays) {
    expect_lines();
}

class Claims : public CommandLines {};
TEST_P(Claims, EndAsTheTableSays) {
    expect_lines();
}

class Runs : public CommandLines {};
TEST_P(Runs, LeaveWhatTheTableSays) {
    expect_lines();
}

class Pictures : public TableLines {};
TEST_P(Pictures, HoldWhatTheTableSays) {
    expect_lines();
}

const auto kName = [](const auto& tested) { return tested.param.name; };
const auto sections_of = [](const char* file) { return testing::ValuesIn(tests::table_sections(file)); };
INSTANTIATE_TEST_SUITE_P(Each, CommandLines, sections_of("program/command_lines.txt"), kName);
INSTANTIATE_TEST_SUITE_P(Each, Claims, sections_of("program/claims.txt"), kName);
INSTANTIATE_TEST_SUITE_P(Each, Runs, sections_of("program/runs.txt"), kName);
INSTANTIATE_TEST_SUITE_P(Each, Pictures, sections_of("program/pictures.txt"), kName);

}  // namespace
}  // namespace conelane::experiments
