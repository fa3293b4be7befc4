// What command lines of the program end by: command_lines.txt says it, and how that table is read.

#include "tests/support/program_fixture.hpp"
#include "tests/support/test_paths.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

struct Section {
    std::string name;
    std::vector<std::string> lines;
    friend void PrintTo(const Section& section, std::ostream* out) { *out << section.name; }
};

std::vector<Section> sections() {
    std::vector<Section> all;
    std::ifstream stream(source_directory() / "tests/program/command_lines.txt");
    for (std::string line; std::getline(stream, line);) {
        if (line.starts_with('[') && line.ends_with(']') && !line.starts_with("[["))
            all.push_back({line.substr(1, line.size() - 2), {}});
        else if (!line.empty() && !line.starts_with('#'))
            all.back().lines.push_back(line);
    }
    return all;
}

std::vector<std::string> split(const std::string& text, const std::string& separator) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0;; begin += parts.back().size() + separator.size()) {
        const std::size_t end = text.find(separator, begin);
        parts.push_back(text.substr(begin, end == std::string::npos ? end : end - begin));
        if (end == std::string::npos) return parts;
    }
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
    return text;
}

class CommandLines : public ProgramFixture, public testing::WithParamInterface<Section> {
  protected:
    void SetUp() override {
        ProgramFixture::SetUp();
        ::setenv("PYTHONHOME", "nowhere", 1);  // pages would take most of the time here
    }
    void make_file(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories(path(name).parent_path());
        file_with(text.empty() ? "" : replaced(text.substr(1), "\\n", "\n") + "\n", name);
    }
    void expect_end(const std::string& command, int exit_code, const std::vector<std::string>& words) {
        const std::size_t begin = command.find("[[");
        if (begin != std::string::npos) {
            const std::size_t end = command.find("]]", begin);
            for (const std::string& choice : split(command.substr(begin + 2, end - begin - 2), "|")) {
                std::vector<std::string> chosen;
                for (const std::string& word : words) chosen.push_back(replaced(word, "[[]]", choice));
                expect_end(std::string(command).replace(begin, end + 2 - begin, choice), exit_code, chosen);
            }
        } else if (exit_code == 2) {
            expect_refused(command, words);
        } else {
            ProgramFixture::expect_end(command, exit_code, words);
        }
    }
};

TEST_P(CommandLines, EndAsTheTableSays) {
    std::size_t ends = 0;
    for (const std::string& line : GetParam().lines) {
        if (line.starts_with("$ ")) {
            run_well(line.substr(2));
        } else if (line.starts_with("! ")) {
            EXPECT_EQ(std::system(("cd " + path("").string() + " && " + line.substr(2)).c_str()), 0) << line;
        } else if (const std::vector<std::string> file = split(line, " <-"); file.size() == 2) {
            make_file(file[0], file[1]);
        } else {
            const bool is_refused = line.find(" => ") != std::string::npos;
            const std::string arrow = is_refused                                ? " => "
                                      : line.find(" =0> ") != std::string::npos ? " =0> "
                                                                                : " =1> ";
            const std::vector<std::string> parts = split(line, arrow);
            ASSERT_EQ(parts.size(), 2U) << line;
            expect_end(parts[0], is_refused ? 2 : arrow[2] - '0', split(parts[1], " ; "));
            ++ends;
        }
    }
    EXPECT_GT(ends, 0U);
}
INSTANTIATE_TEST_SUITE_P(Each, CommandLines, testing::ValuesIn(sections()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace conelane::experiments
