// Scenes in, lanes out, scores of lanes.

#include "evaluation/formats/scene_file.hpp"
#include "tests/support/program_on_scenes.hpp"

namespace conelane::experiments {
namespace {

/// Each line is answered before the next one is sent.
TEST_F(Program, AStreamIsAnsweredLineByLine) {
    make_scenes("--fp 0.2");
    const std::vector<Lane> expected = [&] {
        run_well("detect --method clc --time-limit 60000 --scenes s.scenes.jsonl --out l.lanes.jsonl");
        return lanes_in(path("l.lanes.jsonl"));
    }();
    const std::string in = path("in").string();
    const std::string out = path("out").string();
    ASSERT_EQ(std::system(("mkfifo " + in + " " + out).c_str()), 0);
    ASSERT_EQ(std::system(("(timeout 60 " + conelane_program() +
                           " detect --method clc --time-limit 60000 --scenes - --out - <" + in + " >" + out +
                           "; echo $? >" + path("code").string() + ") &")
                              .c_str()),
              0);
    std::ofstream scenes(in);
    std::ifstream lanes(out);
    std::ifstream file(path("s.scenes.jsonl"));
    std::size_t count = 0;
    for (std::string scene, lane; std::getline(file, scene); ++count) {
        scenes << "{\"reset\": true}\n" << scene << std::endl;
        ASSERT_TRUE(std::getline(lanes, lane));
        const nlohmann::json answer = nlohmann::json::parse(lane);
        EXPECT_EQ(answer["scene"], nlohmann::json::parse(scene)["id"]);
        EXPECT_EQ(answer["left"].get<std::vector<ConeId>>(), expected.at(count).left);
        EXPECT_EQ(answer["right"].get<std::vector<ConeId>>(), expected.at(count).right);
    }
    scenes << "{\"id\": 3}" << std::endl;
    std::string lane;
    ASSERT_TRUE(std::getline(lanes, lane));
    const nlohmann::json wrong = nlohmann::json::parse(lane);
    EXPECT_EQ(wrong["status"], "error");
    EXPECT_EQ(wrong["scene"], std::to_string(2 * count + 1));
    EXPECT_THAT(wrong["message"].get<std::string>(), HasSubstr("id"));
    scenes.close();
    EXPECT_FALSE(std::getline(lanes, lane)) << "it ends with its input";
    EXPECT_TRUE(wait_until([&] { return text_of(path("code")) == "0\n"; }));
    const Outcome whole = run("detect --method clc --time-limit 60000 --scenes s.scenes.jsonl --out -");
    EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(whole.output, '\n')), expected.size());
}

}  // namespace
}  // namespace conelane::experiments
