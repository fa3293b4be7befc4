// `conelane plot` as a user calls it: the picture contains what the scene and the lanes contain.

#include "tests/support/program_fixture.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

using testing::HasSubstr;
using testing::Not;

class PlotCommand : public ProgramFixture {
  protected:
    /// A straight lane of six cones, 4 m apart, the left one without its second cone, which was missed. Cone
    /// 99 is on no boundary of the track.
    void make_scene() {
        file_with(
            R"({"id": "a", "pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [)"
            R"({"id": 1, "x": 2, "y": 1.5}, {"id": 3, "x": 10, "y": 1.5}, {"id": 4, "x": 2, "y": -1.5}, )"
            R"({"id": 5, "x": 6, "y": -1.5}, {"id": 6, "x": 10, "y": -1.5}, {"id": 99, "x": 7, "y": 6}], )"
            R"("ground_truth": {"left": [1, 3], "right": [4, 5, 6], "closed": false}, "track": "t", )"
            R"("condition": "paper", "missed": [{"id": 2, "x": 6, "y": 1.5}]})"
            "\n",
            "s.scenes.jsonl");
        file_with(
            R"({"t": {"left": [[2, 1.5], [6, 1.5], [10, 1.5]], "right": [[2, -1.5], [6, -1.5], [10, -1.5]], )"
            R"("closed": false}})",
            "s.tracks.json");
        file_with(lane("front", "1, 3", "4, 5, 6", R"(, "confidence": 0.9, "trusted_m": 6)"),
                  "front.lanes.jsonl");
        file_with(lane("clc", "1", "4, 5, 6", ""), "clc.lanes.jsonl");
    }

    static std::string lane(const std::string& detector, const std::string& left, const std::string& right,
                            const std::string& more) {
        return R"({"scene": "a", "method": ")" + detector + R"(", "status": "found", "left": [)" + left +
               R"(], "right": [)" + right + R"(], "latency_ms": 1)" + more + "}\n";
    }

    /// The picture of `conelane plot --scenes s.scenes.jsonl --id a ARGUMENTS --out p.svg`.
    std::string svg(const std::string& arguments) {
        const Outcome outcome = run_well("plot --scenes s.scenes.jsonl --id a " + arguments + " --out p.svg");
        EXPECT_EQ(outcome.errors, "");
        return text_of(path("p.svg"));
    }

    /// How many points a group of the picture has.
    static std::size_t points_in(const std::string& picture, const std::string& group) {
        std::size_t at = picture.find("<g id=\"" + group + "\">");
        if (at == std::string::npos) return 0;
        const std::size_t end = picture.find("<g id=", at + 1);
        std::size_t count = 0;
        while ((at = picture.find("<use ", at + 1)) < end) ++count;
        return count;
    }
};

TEST_F(PlotCommand, MarksConesFalseOnesAndMissedOnes) {
    make_scene();
    const std::string picture = svg("--lanes front.lanes.jsonl");
    EXPECT_EQ(points_in(picture, "found-cone"), 5U);
    EXPECT_EQ(points_in(picture, "found-false"), 1U);
    EXPECT_EQ(points_in(picture, "found-missed"), 1U);
    for (const char* words : {">cone<", ">false positive<", ">cone that was missed<", ">ground truth<"})
        EXPECT_THAT(picture, HasSubstr(words));
    // Without a track, the picture does not mention false cones.
    std::filesystem::remove(path("s.tracks.json"));
    const std::string without = svg("--lanes front.lanes.jsonl");
    EXPECT_EQ(points_in(without, "found-cone"), 6U);
    EXPECT_THAT(without, Not(HasSubstr("false positive")));
    EXPECT_THAT(svg("--no-truth"), Not(HasSubstr("ground truth")));
}

TEST_F(PlotCommand, ShowsWhatIsBridgedTrustedAndInferred) {
    make_scene();
    const std::string picture = svg("--lanes front.lanes.jsonl");
    EXPECT_THAT(picture, HasSubstr(">front, confidence 90.0 %, trusted 6.0 m<"));
    EXPECT_THAT(picture, HasSubstr(">bridged gap<"));  // 8 m on the left
    EXPECT_THAT(picture, HasSubstr(">trusted up to here<"));
    EXPECT_THAT(picture, Not(HasSubstr(">boundary inferred<")));
    const std::string plain = svg("--lanes clc.lanes.jsonl");
    for (const char* words : {"bridged", "trusted", "inferred"}) EXPECT_THAT(plain, Not(HasSubstr(words)));
    file_with(lane("front", "", "4, 5, 6", ""), "right.lanes.jsonl");
    EXPECT_THAT(svg("--lanes right.lanes.jsonl"), HasSubstr(">boundary inferred<"));
}

TEST_F(PlotCommand, DrawsSeveralDetectorsOrThoseThatAreNamed) {
    make_scene();
    const std::string both = svg("--lanes front.lanes.jsonl clc.lanes.jsonl --title 'two methods'");
    for (const char* words : {">front, ", ">clc<", ">two methods<"}) EXPECT_THAT(both, HasSubstr(words));
    const std::string one = svg("--lanes front.lanes.jsonl clc.lanes.jsonl --method clc");
    EXPECT_THAT(one, HasSubstr(">clc<"));
    EXPECT_THAT(one, Not(HasSubstr(">front, ")));
    const std::string given = svg("--lanes clc.lanes.jsonl --given");
    EXPECT_THAT(given, HasSubstr(">given: 6 cones and the pose<"));
    EXPECT_EQ(points_in(given, "given-cone"), 6U);
    EXPECT_EQ(points_in(given, "found-false"), 1U);
    EXPECT_EQ(svg("--lanes clc.lanes.jsonl --given"), given);
}

TEST_F(PlotCommand, DrawsCandidatesAndClosedLanes) {
    make_scene();
    file_with(lane("clc", "1, 3", "4, 6",
                   R"(, "iterations": 9, "complete": true, "candidates": )"
                   R"([{"left": [1, 99], "right": [4, 5], "iteration": 1}])"),
              "many.lanes.jsonl");
    EXPECT_THAT(svg("--lanes many.lanes.jsonl"), HasSubstr(">steps of its candidates<"));
    file_with(R"({"id": "a", "pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [{"id": 1, "x": 2, "y": -1}, )"
              R"({"id": 2, "x": 4, "y": 1}, {"id": 3, "x": 4, "y": -1}, {"id": 4, "x": 0, "y": -3}, )"
              R"({"id": 5, "x": 6, "y": 3}, {"id": 6, "x": 6, "y": -3}], "ground_truth": )"
              R"({"left": [1, 3, 2], "right": [4, 6, 5], "closed": true}})"
              "\n",
              "s.scenes.jsonl");
    file_with(lane("clc", "1, 3, 2", "4, 6, 5", R"(, "closed": true)"), "ring.lanes.jsonl");
    const std::string ring = svg("--lanes ring.lanes.jsonl");
    EXPECT_THAT(ring, HasSubstr(">ground truth<"));
    EXPECT_EQ(points_in(ring, "found-cone"), 6U);
}

TEST_F(PlotCommand, WritesPngByItsEnding) {
    make_scene();
    run_well("plot --scenes s.scenes.jsonl --id a --lanes clc.lanes.jsonl --out p.png");
    EXPECT_TRUE(text_of(path("p.png")).starts_with("\x89PNG\r\n"));
}

}  // namespace
}  // namespace conelane::experiments
