// Training, tuning and studies through the program.

#include "evaluation/formats/parameter_file.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "tests/support/program_on_scenes.hpp"
#include "tests/support/testing.hpp"

#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

TEST_F(Program, TuneWithContextAndShapeLeavesARecordThatTheColorStudyUses) {
    const std::string tune =
        "tune --tracks generated:circle generated:straight --nearest 8 --context 16 --fp 0.3 --every 30 "
        "--shape --folds 2 --rounds 1 --evaluations 3 --time-limit 1000 --log p.jsonl --out p.json";
    const Outcome tuned = run_well(tune);
    EXPECT_THAT(tuned.output, HasSubstr("held out circle"));
    const nlohmann::json record = nlohmann::json::parse(text_of(path("p.record.json")));
    EXPECT_EQ(record["nearest"], 8);
    EXPECT_EQ(record["context"], 16);
    EXPECT_EQ(record["shape"], true);
    EXPECT_EQ(record["rounds"], 1);
    EXPECT_TRUE(has_shape_costs(read_rld_parameters(path("p.json"))));
    std::size_t counted = 0;
    for (const auto& [cause, scenes] : record["losses"]["0.3"].items()) counted += scenes.get<std::size_t>();
    EXPECT_GT(counted, 5U);
    EXPECT_TRUE(record.contains("wrong_cones"));
    EXPECT_EQ(run(tune).output, tuned.output) << "from its log";

    const Outcome study = run_well("study confidence-and-colour --record p.record.json --out study.jsonl");
    EXPECT_THAT(study.output, HasSubstr("colours, 20 % wrong"));
    // Geometry alone, on the held-out tracks, gives the figures of the tuning.
    const nlohmann::json geometry = json_lines("study.jsonl").front();
    EXPECT_EQ(geometry["known"], "geometry alone");
    EXPECT_EQ(geometry["context"], 16);
    EXPECT_NEAR(geometry["accurate"].get<double>(), record["held_out_figures"]["mean"].get<double>(), 1e-12);
    expect_refused("study confidence-and-colour --record p.json", {"p.json"});
    expect_refused("study confidence-and-colour --record p.record.json --tracks generated:circle",
                   {"--tracks", "straight"});
}

TEST_F(Program, ExactnessIsMeasuredOnStoredScenes) {
    make_scenes("--fp 0.2");
    const Outcome optimality = run_well("study optimality --scenes s.scenes.jsonl --out optimality.jsonl");
    EXPECT_THAT(optimality.output, HasSubstr("equal %"));
    const std::vector<nlohmann::json> rows = json_lines("optimality.jsonl");
    for (const nlohmann::json& row : rows) {
        if (!row.contains("gap")) continue;
        const double optimum = row.at("optimum").at("objective");
        const double candidate = row.at("candidate").at("objective");
        EXPECT_DOUBLE_EQ(row.at("gap"),
                         std::max(0.0, candidate - optimum) / std::max(1.0, std::abs(optimum)));
    }
    EXPECT_EQ(rows.size(), read_scenes(path("s.scenes.jsonl")).size());
    const Outcome backends =
        run_well("study backends --scenes s.scenes.jsonl --sizes 6 --out backends.jsonl");
    EXPECT_THAT(backends.output, HasSubstr("cbc-main/tight"));
    EXPECT_THAT(backends.output, HasSubstr("exhaustive"));
    const Outcome printed =
        run_well("study backends --scenes s.scenes.jsonl --sizes 6,10 --solvers all,cbc-main/paper");
    EXPECT_THAT(printed.output, HasSubstr("cbc-main/paper"));
    EXPECT_THAT(printed.output, HasSubstr("exhaustive takes at most 9 cones: left out at n = 10"));
    const Outcome all = run_well(
        "study backends --scenes s.scenes.jsonl --sizes 6,all --solvers path-pair --limit 3 --out all.jsonl");
    EXPECT_THAT(all.output, HasSubstr("all path-pair"));
    std::map<std::string, std::size_t> visible;
    for (const AnnotatedScene& scene : read_scenes(path("s.scenes.jsonl")))
        visible[scene.scene.id] = scene.scene.cones.size();
    std::size_t with_all = 0;
    for (const nlohmann::json& row : json_lines("all.jsonl")) {
        if (!row.contains("scene")) continue;
        const bool is_all = row.at("nearest") == 0;
        EXPECT_EQ(row.at("cones"), is_all ? visible.at(row.at("scene")) : 6U) << row;
        with_all += is_all ? 1 : 0;
    }
    EXPECT_EQ(with_all, 3U);
    expect_end("study", 0, {"confidence-and-colour  how much more accurate"});
    const Outcome beams = run("study front-beam --scenes s.scenes.jsonl --beams 5,15 --reference-beam 40");
    EXPECT_THAT(beams.output, HasSubstr("best score"));
}

}  // namespace
}  // namespace conelane::experiments
