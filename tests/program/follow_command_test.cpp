// `conelane drive --follow` as a car, a simulator or a script calls it.

#include "tests/support/planner_frames.hpp"
#include "tests/support/program_fixture.hpp"
#include "tests/support/recorded_tracks.hpp"

namespace conelane::experiments {
namespace {

using nlohmann::json;

json to_json(const Frame& frame, bool with_time) {
    json cones = json::array();
    for (const Cone& cone : frame.cones) {
        json c{{"x", cone.position.x()}, {"y", cone.position.y()}, {"color", to_string(cone.color)}};
        if (cone.id != kNoId) c["id"] = cone.id;
        cones.push_back(c);
    }
    json line{{"pose",
               {{"x", frame.pose.position.x()}, {"y", frame.pose.position.y()}, {"yaw", frame.pose.yaw_rad}}},
              {"cones", cones}};
    if (with_time) line["time_s"] = frame.time_s;
    return line;
}

/// The same frame as ft-fsd records it.
json to_ft_fsd(const Frame& frame) {
    json lists = json::array({json::array(), json::array(), json::array(), json::array(), json::array()});
    for (const Cone& cone : frame.cones) lists[0].push_back({cone.position.x(), cone.position.y()});
    return {{"car_position", {frame.pose.position.x(), frame.pose.position.y()}},
            {"car_direction", {std::cos(frame.pose.yaw_rad), std::sin(frame.pose.yaw_rad)}},
            {"slam_cones", lists}};
}

class FollowCommand : public ProgramFixture {
  protected:
    Outcome follow(const std::string& arguments) { return run("drive " + arguments); }
    /// The oval at 6 m/s, with ten frames a second.
    static std::vector<Frame> frames(double to_m, bool with_ids = true) {
        std::vector<Frame> all;
        const tests::DrivenCourse course = tests::oval(1);
        for (int i = 0; 0.6 * i <= to_m; ++i)
            all.push_back(tests::frame_at(course, 0.6 * i, 0.1 * i, {.with_ids = with_ids}));
        return all;
    }
    static std::string lines_of(const std::vector<Frame>& frames, bool with_time = true) {
        std::string text;
        for (const Frame& frame : frames) text += to_json(frame, with_time).dump() + "\n";
        return text;
    }
    std::vector<json> plans_in(const std::string& text) {
        return mapped(ProgramFixture::lines_of(text),
                      [](const std::string& line) { return json::parse(line); });
    }
};

TEST_F(FollowCommand, WritesAPlanForEachFrame) {
    file_with(lines_of(frames(6.0)), "run.frames.jsonl");
    const Outcome outcome = follow("--follow run.frames.jsonl --out p.jsonl --time-limit inf");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_EQ(outcome.output + outcome.errors, "");
    const std::vector<json> plans = plans_in(text_of(path("p.jsonl")));
    ASSERT_EQ(plans.size(), 11U);
    const json& plan = plans[8];
    EXPECT_EQ(plan.at("frame"), 9);
    EXPECT_NEAR(plan.at("time_s"), 0.8, 1e-9);
    EXPECT_EQ(plan.at("state"), "following");
    EXPECT_EQ(plan.at("lap"), 0);
    EXPECT_EQ(plan.at("stop"), false);
    EXPECT_EQ(plan.at("age_s"), 0.0);
    EXPECT_EQ(plan.at("answer").at("status"), "found");
    EXPECT_GT(plan.at("answer").at("confidence"), 0.0);
    EXPECT_GT(plan.at("safe_m"), 3.0);
    EXPECT_LE(plan.at("safe_m"), plan.at("length_m"));
    EXPECT_FALSE(plan.contains("phase"));
    const json& point = plan.at("points").at(2);
    EXPECT_DOUBLE_EQ(point.at("s_m"), 1.0);
    EXPECT_NEAR(point.at("x_m"), 5.8, 0.3);
    EXPECT_NEAR(point.at("y_m"), 0.0, 0.3);
    EXPECT_NEAR(point.at("width_left_m"), 1.75, 0.3);
    // A second run gives the same bytes.
    EXPECT_EQ(follow("--follow run.frames.jsonl --out q.jsonl --time-limit inf").exit_code, 0);
    EXPECT_EQ(text_of(path("p.jsonl")), text_of(path("q.jsonl")));
}

TEST_F(FollowCommand, TheFormsOfARunAreTheSameRun) {
    const std::vector<Frame> run = frames(6.0, false);
    json list = json::array();
    std::string stream;
    for (const Frame& frame : run) {
        list.push_back(to_ft_fsd(frame));
        stream += to_ft_fsd(frame).dump() + "\n";
    }
    file_with(lines_of(run, false), "own.frames.jsonl");
    file_with(list.dump(2), "run.json");
    file_with(stream, "stream.jsonl");
    for (const char* const more : {"", " --interval 0.2"}) {
        SCOPED_TRACE(more);
        const std::string rest = std::string(" --time-limit inf") + more;
        ASSERT_EQ(follow("--follow own.frames.jsonl --out a.jsonl" + rest).exit_code, 0);
        ASSERT_EQ(follow("--follow run.json --out b.jsonl" + rest).exit_code, 0);
        const Outcome streamed = follow("--follow - --out -" + rest + " <stream.jsonl");
        const std::vector<json> own = plans_in(text_of(path("a.jsonl")));
        const std::vector<json> listed = plans_in(text_of(path("b.jsonl")));
        const std::vector<json> answered = plans_in(streamed.output);
        ASSERT_EQ(own.size(), run.size());
        ASSERT_EQ(listed.size(), run.size());
        ASSERT_EQ(answered.size(), run.size());
        for (std::size_t i = 0; i < run.size(); ++i) {
            EXPECT_NEAR(own[i].at("time_s"), (*more != '\0' ? 0.2 : 0.1) * static_cast<double>(i), 1e-9);
            EXPECT_EQ(own[i].at("time_s"), listed[i].at("time_s"));
            EXPECT_EQ(own[i].at("state"), listed[i].at("state"));
            ASSERT_EQ(own[i].at("points").size(), listed[i].at("points").size());
            EXPECT_EQ(answered[i], listed[i]);
        }
    }
}

TEST_F(FollowCommand, AStreamIsAnsweredLineByLine) {
    const std::vector<Frame> run = frames(3.0);
    json broken = to_json(run[2], true);
    broken["cones"][3]["id"] = broken["cones"][0]["id"];
    std::string text = lines_of({run[0], run[1]}) + "no frame\n\n" + broken.dump() + "\n" +
                       R"({"cones": [], "time_s": 0.3})" + "\n" + lines_of({run[2]}) + "{\"reset\": true}\n" +
                       R"({"pose": {"x": 0, "y": 0, "yaw": 0}, "cones": []})" + "\n";
    file_with(text, "in.jsonl");
    const Outcome outcome = follow("--follow - --out - --time-limit inf <in.jsonl");
    EXPECT_EQ(outcome.exit_code, 0);
    const std::vector<json> plans = plans_in(outcome.output);
    ASSERT_EQ(plans.size(), 7U);
    EXPECT_EQ(plans[1].at("state"), "following");
    EXPECT_EQ(plans[2].at("frame"), 3);
    EXPECT_THAT(plans[2].at("error"), HasSubstr("line 3"));
    EXPECT_EQ(plans[3].at("frame"), 5);
    EXPECT_THAT(plans[3].at("error"), HasSubstr("cones[3].id"));
    EXPECT_THAT(plans[4].at("error"), HasSubstr("pose"));
    EXPECT_EQ(plans[5].at("frame"), 7);
    EXPECT_EQ(plans[5].at("state"), "following") << "what was refused changed nothing";
    EXPECT_EQ(plans[6].at("state"), "searching") << "another run";
    EXPECT_EQ(plans[6].at("time_s"), 0.0);
    EXPECT_THAT(outcome.errors, HasSubstr("front-warm"));
    EXPECT_THAT(outcome.errors, HasSubstr("3"));
    EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1);
}

TEST_F(FollowCommand, ALapGivesTheCourseAndTheStop) {
    const tests::DrivenCourse course = tests::oval(1);
    file_with(lines_of(frames(course.lap_m + 6.0)), "run.frames.jsonl");
    const std::string run = "--follow run.frames.jsonl --mission autocross --time-limit inf ";
    ASSERT_EQ(follow(run + "--out p.jsonl").exit_code, 0);
    const json last = plans_in(text_of(path("p.jsonl"))).back();
    EXPECT_EQ(last.at("state"), "finished");
    EXPECT_EQ(last.at("stop"), true);
    EXPECT_EQ(last.at("lap"), 1);
    ASSERT_EQ(follow(run + "--format tum --out c.csv").exit_code, 0);
    const std::string tum = text_of(path("c.csv"));
    EXPECT_THAT(tum, StartsWith("# x_m,y_m,w_tr_right_m,w_tr_left_m\n"));
    EXPECT_NEAR(static_cast<double>(std::ranges::count(tum, '\n')), course.lap_m / 0.5, 6.0);
    ASSERT_EQ(follow(run + "--format ftfsd --step 2 --out d.csv").exit_code, 0);
    EXPECT_THAT(text_of(path("d.csv")), StartsWith("# s_m,x_m,y_m,curvature_1pm\n0.000000,"));
    // Another detector, and more laps than the frames have.
    ASSERT_EQ(follow("--follow run.frames.jsonl --method clc --laps 2 --out e.jsonl").exit_code, 0);
    EXPECT_NE(plans_in(text_of(path("e.jsonl"))).back().at("state"), "finished");
}

TEST_F(FollowCommand, APagePlaysTheRunAndSaysWhereThereWasNoLane) {
    std::vector<Frame> run = frames(6.0);
    for (std::size_t i = 4; i < 7; ++i) run[i].cones.clear();
    file_with(lines_of(run), "run.frames.jsonl");
    const Outcome outcome = follow("--follow run.frames.jsonl --out p.jsonl --page p.html --time-limit inf");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    const std::string page = text_of(path("p.html"));
    const std::string begin = R"(id="race-data">)";
    const std::size_t from = page.find(begin) + begin.size();
    const json race = json::parse(page.substr(from, page.find("</script>", from) - from));
    const std::vector<json> plans = plans_in(text_of(path("p.jsonl")));
    ASSERT_EQ(race.at("frames").size(), plans.size());
    for (std::size_t i = 0; i < plans.size(); ++i)
        EXPECT_EQ(race.at("frames")[i].at("state"), plans[i].at("state")) << i;
    EXPECT_GT(race.at("frames")[0].at("left").size(), 8U);
    EXPECT_THAT(page, HasSubstr(R"(data-frame="4")"));
    EXPECT_THAT(page, HasSubstr("fewer than 3 cones within 20 m ahead"));
    // A page that cannot be made leaves the old files.
    EXPECT_EQ(follow("--follow run.frames.jsonl --out p.jsonl --page none/p.html").exit_code, 2);
    EXPECT_EQ(plans_in(text_of(path("p.jsonl"))), plans);
    EXPECT_THAT(follow("--follow - --out - --page q.html <run.frames.jsonl").errors, HasSubstr("--page: "));
}

TEST_F(FollowCommand, ARealSkidpadIsFollowed) {
    const std::filesystem::path file = recorded_data() / "ft_fsd" / "skidpad.json";
    if (!std::filesystem::exists(file)) {
        GTEST_SKIP() << "no recorded runs in CONELANE_DATA or in ../shared/data";
    }
    const Outcome outcome = follow("--follow " + file.string() + " --mission skidpad --out p.jsonl");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    const std::vector<json> plans = plans_in(text_of(path("p.jsonl")));
    EXPECT_EQ(plans.size(), 341U);
    EXPECT_EQ(plans.front().at("phase"), "approach");
    EXPECT_EQ(plans.back().at("phase"), "exit");
}

}  // namespace
}  // namespace conelane::experiments
