// Detectors and solvers whose answers are all errors: every command says so on stderr and exits with 1. Its
// output is written all the same.

#include "tests/support/program_on_scenes.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

using testing::HasSubstr;

class Unanswered : public Program {
  protected:
    /// Exit code 1, and one line on stderr that begins and continues like this.
    static void expect_unanswered(const Outcome& outcome, const std::string& begin, const std::string& more) {
        EXPECT_EQ(outcome.exit_code, 1);
        EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << outcome.errors;
        EXPECT_TRUE(outcome.errors.starts_with("conelane: " + begin)) << outcome.errors;
        EXPECT_THAT(outcome.errors, HasSubstr(more));
    }
};

TEST_F(Unanswered, ADetectionOfErrorsAloneEndsBy1) {
    make_scenes("");
    const auto scenes = std::ranges::count(text_of(path("s.scenes.jsonl")), '\n');
    const std::string count = std::to_string(scenes) + " of " + std::to_string(scenes);
    expect_unanswered(run("detect --method exec:mine=false --scenes s.scenes.jsonl --out l.lanes.jsonl"),
                      "mine: " + count + " answers are errors, the first to kidney/pose_0000",
                      "the program ");
    EXPECT_EQ(read_lanes(path("l.lanes.jsonl")).size(), static_cast<std::size_t>(scenes));
    const Outcome streamed = run("detect --method exec:mine=false --scenes s.scenes.jsonl --out -");
    expect_unanswered(streamed, "mine: " + count, "the program ");
    EXPECT_EQ(std::ranges::count(streamed.output, '\n'), scenes);
    // None of these lanes can be driven.
    expect_unanswered(run("drive --lanes l.lanes.jsonl --scenes s.scenes.jsonl --out d.jsonl"),
                      "mine: " + count, "kidney/pose_0000");
    EXPECT_EQ(std::ranges::count(text_of(path("d.jsonl")), '\n'), scenes);
}

TEST_F(Unanswered, AComparisonInWhichOneDetectorAnswersNothingEndsBy1) {
    const Outcome outcome = run(
        "compare --tracks generated:circle --condition paper --fp 0 --every 30 --methods exec:mine=false clc "
        "--out r");
    expect_unanswered(outcome, "mine: ", "answers are errors, the first to circle/pose_0000");
    EXPECT_THAT(outcome.output, HasSubstr("clc"));
    EXPECT_TRUE(std::filesystem::exists(path("r/results.jsonl")));
    // In the table, each scene is in one column: error, and not none as well.
    std::istringstream table(text_of(path("r/table.txt")));
    std::vector<std::string> header;
    for (std::string line; std::getline(table, line);) {
        const bool is_header = header.empty();
        if (!is_header && !line.starts_with("mine ")) continue;
        // Titles are separated by two blanks, because some contain one.
        std::vector<std::string> cells;
        for (std::size_t begin = 0; begin < line.size();) {
            const std::size_t end = std::min(line.find("  ", begin), line.size());
            cells.push_back(line.substr(begin, end - begin));
            begin = std::min(line.find_first_not_of(' ', end), line.size());
        }
        if (is_header) {
            header = cells;
            continue;
        }
        ASSERT_EQ(cells.size(), header.size()) << line;
        const auto cell = [&](const std::string& title) {
            return cells[static_cast<std::size_t>(std::ranges::find(header, title) - header.begin())];
        };
        EXPECT_EQ(cell("error %"), "100.0");
        EXPECT_EQ(cell("none %"), "0.0");
        return;
    }
    FAIL() << "no line of the method";
}

TEST_F(Unanswered, CertificatesThatClaimNothingEndBy1) {
    make_scenes("--fp 0.3");
    const auto scenes = std::ranges::count(text_of(path("s.scenes.jsonl")), '\n');
    for (const std::string whole : {"", "--whole "}) {
        const std::string certify = "certify " + whole + "--scenes s.scenes.jsonl --out c.jsonl ";
        const Outcome none = run(certify + "--time-limit 1e-6");
        EXPECT_EQ(none.exit_code, 1);
        EXPECT_EQ(std::ranges::count(none.errors, '\n'), scenes) << none.errors;
        EXPECT_THAT(none.errors, HasSubstr("kidney/pose_0000/fp_0.30/range_30: nothing is claimed"));
        EXPECT_EQ(std::ranges::count(text_of(path("c.jsonl")), '\n'), scenes);
        const Outcome verified = run("certify --scenes s.scenes.jsonl --verify c.jsonl");
        if (!whole.empty()) {
            EXPECT_EQ(verified.exit_code, 1);
            EXPECT_EQ(verified.errors, "conelane: c.jsonl: no certificate is verified\n");
        }
        const Outcome all = run_well(certify + "--nearest 12");
        EXPECT_EQ(all.errors, "");
    }
}

TEST_F(Unanswered, AnErrorAmongAnswersIsSaidAndIsNoFailure) {
    make_scenes("");
    run_well("detect --method clc --scenes s.scenes.jsonl --out l.lanes.jsonl");
    const std::string lanes = text_of(path("l.lanes.jsonl"));
    const std::string first = read_lanes(path("l.lanes.jsonl")).front().scene;
    file_with(R"({"scene":")" + first +
                  R"(","method":"clc","status":"error","left":[],"right":[],"closed":false,"latency_ms":1,)"
                  R"("message":"two\nlines"})" +
                  lanes.substr(lanes.find('\n')),
              "l.lanes.jsonl");
    expect_end("drive --lanes l.lanes.jsonl --scenes s.scenes.jsonl --out d.jsonl", 0,
               {"clc: 1 of ", first + ": two lines\n"});
}

}  // namespace
}  // namespace conelane::experiments
