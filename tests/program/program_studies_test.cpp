// Training, tuning and studies through the program.

#include "evaluation/formats/scene_file.hpp"
#include "tests/support/program_on_scenes.hpp"
#include "tests/support/text_tables.hpp"

namespace conelane::experiments {
namespace {

using testing::HasSubstr;

TEST_F(Program, TuneWithContextAndShapeLeavesARecord) {
    const Outcome tuned = run_well(
        "tune --tracks generated:circle generated:straight --nearest 8 --context 16 --fp 0.3 --every 30 "
        "--shape --evaluations 3 --time-limit 1000 --out p.json");
    EXPECT_THAT(tuned.output, HasSubstr("accuracy on "));
    const nlohmann::json record = nlohmann::json::parse(text_of(path("p.record.json")));
    EXPECT_EQ(record["nearest"], 8);
    EXPECT_EQ(record["context"], 16);
    EXPECT_EQ(record["shape"], true);
    EXPECT_GE(record["figure"], record["figure_of_start"]);
    EXPECT_TRUE(has_shape_costs(read_rld_parameters(path("p.json"))));
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
    expect_end("study", 0, {"front-beam  "});
    const Outcome beams = run("study front-beam --scenes s.scenes.jsonl --beams 5,15 --reference-beam 40");
    EXPECT_THAT(beams.output, HasSubstr("best score"));
}

TEST_F(Program, ShardsOfASolverStudyAreJoinedWithoutSolvingAgain) {
    run_well(
        "scenes --tracks generated:circle generated:straight --fp 0.3 --range 25 --every 40 --out "
        "s.scenes.jsonl");
    const std::string study =
        "study backends --scenes s.scenes.jsonl --sizes 8 --solvers path-pair,cbc --out ";
    run_well(study + "0.jsonl --shard 0/2 --time-limit 0.001 --then 30000");
    run_well(study + "1.jsonl --shard 1/2");
    run_well(study + "whole.jsonl --stored 0.jsonl,1.jsonl");
    const auto solves = [&](const std::vector<std::string>& files) {
        std::map<std::string, double> latencies_ms;
        for (const std::string& file : files) {
            for (const nlohmann::json& row : json_lines(file)) {
                if (!row.contains("row"))
                    latencies_ms[row["backend"].get<std::string>() + row["scene"].get<std::string>()] =
                        row["latency_ms"];
            }
        }
        return latencies_ms;
    };
    EXPECT_EQ(solves({"whole.jsonl"}), solves({"0.jsonl", "1.jsonl"}));
    std::set<double> limits_ms;
    for (const nlohmann::json& row : json_lines("whole.jsonl")) {
        if (row.value("row", "") == "summary") {
            EXPECT_TRUE(row.contains("par10_ms_interval")) << "two courses";
        }
        if (!row.contains("row")) limits_ms.insert(row["limit_ms"].get<double>());
    }
    EXPECT_EQ(limits_ms, (std::set<double>{1000.0, 30000.0}));
    // Solved again are the scenes whose cones have changed; a refuted proof does not become one.
    std::string text = text_of(path("whole.jsonl"));
    file_with(tests::replaced(text, R"("scene_hash":")", R"("scene_hash":"other)"), "changed.jsonl");
    run_well(study + "again.jsonl --stored changed.jsonl");
    EXPECT_NE(solves({"again.jsonl"}), solves({"whole.jsonl"}));
    file_with(tests::replaced(text, R"("status":"optimal")", R"("status":"error","refuted":true)"),
              "refuted.jsonl");
    (void)run(study + "same.jsonl --stored refuted.jsonl");
    for (const nlohmann::json& row : json_lines("same.jsonl")) {
        if (!row.contains("row")) {
            EXPECT_EQ(row["status"], "error");
        }
    }
    expect_refused(study + "x.jsonl --params shape --stored 0.jsonl", {"0.jsonl:1", "parameters"});
    expect_refused(study + "x.jsonl --time-limit 100 --then 50", {"--then", "ascending"});
    expect_refused(study + "x.jsonl --shard 2/2", {"--shard", "2/2"});
}

}  // namespace
}  // namespace conelane::experiments
