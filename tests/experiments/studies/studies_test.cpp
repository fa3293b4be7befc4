// Studies: what is listed, and the aggregations of solves under one objective.

#include "conelane/relaxation_solvers.hpp"
#include "experiments/studies/solve_rows.hpp"
#include "solvers/registry.hpp"
#include "tests/support/measured_study.hpp"
#include "tests/support/straight_scene.hpp"

namespace conelane::experiments {
namespace {

SceneSet straight_set(std::size_t scenes = 1) {
    return {std::vector<AnnotatedScene>(scenes, straight_scene()), {}};
}

SceneSet scenes_of(const std::vector<std::string>& tracks, double rate, double every_m) {
    SceneOptions options{.false_positive_rates = {rate}, .ranges_m = {30.0}, .every_m = every_m};
    return make_scene_set(tracks, options);
}

TEST(Studies, HaveANameOfTheirOwnAQuestionAndAProtocol) {
    std::set<std::string_view> names;
    for (const auto& study : make_studies()) {
        const StudyDescription& description = study->description();
        EXPECT_TRUE(names.insert(description.name).second) << description.name;
        EXPECT_THAT(description.name, testing::MatchesRegex("[a-z-]+"));
        EXPECT_TRUE(description.question.ends_with('?')) << description.question;
        EXPECT_FALSE(description.protocol.empty());
    }
    EXPECT_GE(names.size(), 5U);
}

TEST(TextTable, MakesEveryColumnAsWideAsItsWidestCell) {
    TextTable table({{"n"}, {"solver", true}, {"ms"}});
    table.add({"6", "cbc", fixed(12.345, 1)});
    table.add({"12", "path-pair", fixed({}, 1)});
    EXPECT_EQ(table.text(),
              " n solver      ms\n"
              " 6 cbc       12.3\n"
              "12 path-pair    -\n");
    EXPECT_EQ(percent(share(1, 3), 2), "33.33");
    EXPECT_EQ(percent(share(0, 0), 2), "-");
}

struct Fruit {
    std::string kind;
    std::optional<double> mass_kg;
};

TEST(RowFields, MakeFileTableAndStatisticsOfGroups) {
    const std::vector<Fruit> fruits{{"pear", 0.25}, {"plum", {}}, {"pear", 0.75}};
    const RowFields<Fruit> fields{
        {"kind", &Fruit::kind, Shown::text("kind")},
        {"mass_kg", &Fruit::mass_kg, Shown::fixed("kg", 1)},
        {"", [](const Fruit& fruit) { return fruit.kind.size(); }, Shown::number("letters")}};
    EXPECT_EQ(row_json(fruits[0], fields).dump(), R"({"kind":"pear","mass_kg":0.25})");
    EXPECT_EQ(row_json(fruits[1], fields).dump(), R"({"kind":"plum"})");
    EXPECT_EQ(row_table(fruits, fields),
              "kind  kg letters\n"
              "pear 0.2       4\n"
              "plum   -       4\n"
              "pear 0.8       4\n");
    const RowFields<RowGroup<Fruit>> of_groups{{"kind", first_of(&Fruit::kind)},
                                               {"count", &RowGroup<Fruit>::size},
                                               {"known", share_of(&Fruit::mass_kg)},
                                               {"mean_kg", mean_of(&Fruit::mass_kg)},
                                               {"most_kg", quantile_of(&Fruit::mass_kg, 1.0)}};
    const auto lines = mapped(groups_of<Fruit>(fruits, [](const Fruit& fruit) { return fruit.kind; }),
                              [&](const auto& group) { return row_json(group, of_groups).dump(); });
    EXPECT_THAT(lines, ElementsAre(R"({"kind":"pear","count":2,"known":1.0,"mean_kg":0.5,"most_kg":0.75})",
                                   R"({"kind":"plum","count":1,"known":0.0})"));
}

TEST(SolveRows, AreSpreadEvenlyOverTheScenesThatHaveTheCones) {
    const SceneSet set = straight_set(10);  // 20 cones each
    SolveOptions options{.backends = {Backend{"path-pair"}}, .sizes = {20, 21, 6}};
    options.limit = 3;
    const auto solved = mapped(solve_scenes(set.scenes, options).rows,
                               [](const SolveRow& row) { return std::pair(row.size, row.scene); });
    const AnnotatedScene* const first = set.scenes.data();
    using Solved = std::pair<std::size_t, const AnnotatedScene*>;
    EXPECT_THAT(solved, ElementsAre(Solved(20, first), Solved(20, first + 3), Solved(20, first + 6),
                                    Solved(6, first), Solved(6, first + 3), Solved(6, first + 6)));
    options.backends = {Backend{"magic"}};
    EXPECT_THROW((void)solve_scenes(set.scenes, options), InvalidInput);
}

TEST(Backends, HaveNamesWithAndWithoutAFormulation) {
    EXPECT_EQ(backend_of("path-pair").label(), "path-pair");
    EXPECT_EQ(backend_of("cbc").label(), "cbc/tight");
    EXPECT_EQ(backend_of("cbc/paper").label(), "cbc/paper");
    EXPECT_EQ(backend_of("cbc/all-rows").label(), "cbc/tight whole");
    EXPECT_EQ(backend_of("exec:a/paper/all-rows=run b/all-rows").label(), "a/paper whole");
    for (const char* bad : {"magic", "lp-rounding", "path-pair/tight", "cbc/", "cbc/loose", "/tight", "",
                            "path-pair/all-rows", "cbc/all-rows/tight", "/all-rows"})
        EXPECT_THROW((void)backend_of(bad), InvalidInput) << bad;
}

TEST(Backends, SolveOnlyTheSizesThatTheyTake) {
    std::vector<std::string> solved;
    for (const SolveRow& row :
         solve_scenes(straight_set().scenes,
                      {.backends = {backend_of("exhaustive"), backend_of("path-pair")}, .sizes = {6, 10, 0}})
             .rows) {
        solved.push_back(size_name(row.size) + " " + row.backend.solver);
        EXPECT_TRUE(row.is_optimal());
    }
    EXPECT_THAT(solved, ElementsAre("6 exhaustive", "6 path-pair", "10 path-pair", "all path-pair"));
}

/// `conelane study` ends with 1 if a backend answers none of the scenes of a size.
TEST(Backends, OneThatAnswersNoSceneOfASizeIsNamed) {
    const AnnotatedScene scene = straight_scene();
    std::vector<SolveRow> rows(4);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        rows[k].scene = &scene;
        rows[k].backend = backend_of("cbc");
        rows[k].size = k < 2 ? 6 : 8;
        rows[k].status = k == 3 ? SolveStatus::error : SolveStatus::optimal;
    }
    rows[3].message = "out of paper";
    EXPECT_FALSE(errors_among(rows).any_answered_nothing());
    EXPECT_THAT(errors_among(rows).lines(), ElementsAre(HasSubstr("cbc/tight n=8: 1 of 2 answers")));
    rows[2].status = SolveStatus::error;
    EXPECT_TRUE(errors_among(rows).any_answered_nothing());
}

TEST(Backends, AgreeWithAndWithoutAStart) {
    const SceneSet set = scenes_of({"generated:kidney", "generated:straight"}, 0.2, 20.0);
    SolveOptions options{.sizes = {8, 10}};
    std::vector<Backend> backends = exact_backends();
    backends.push_back(backend_of("cbc-main/paper"));
    for (Backend backend : backends) {
        options.backends.push_back(backend);
        backend.warm_start = true;
        options.backends.push_back(backend);
    }
    std::map<std::pair<std::size_t, std::string>, double> optimum;
    std::set<std::string> labels;
    for (const SolveRow& row : solve_scenes(set.scenes, options).rows) {
        SCOPED_TRACE(row.scene->scene.id + " " + row.backend.label());
        labels.insert(row.backend.label());
        EXPECT_THAT(row.message, "");
        if (row.status == SolveStatus::stopped || row.status == SolveStatus::feasible) continue;
        ASSERT_TRUE(row.is_proven());
        const double value = row.is_optimal() ? *row.objective : 1e9;
        const auto known = optimum.try_emplace({row.cones, row.scene->scene.id}, value).first;
        EXPECT_NEAR(value, known->second, 1e-6);
    }
    EXPECT_EQ(labels.size(), options.backends.size());
    EXPECT_TRUE(labels.contains("path-pair"));
    EXPECT_TRUE(labels.contains("cbc-main/paper warm"));
}

/// A cone every 4 m on both sides of a lane of 3.5 m: each has the one across, those of the ends one
/// neighbour along, all others two; the diagonal is 5.3 m.
TEST(Growth, CountsConesEdgesAndNeighbours) {
    const StudyResult result = measured("growth", "--sizes 6,20,30", straight_set());
    ASSERT_EQ(result.rows.size(), 2U);  // 6, and all 20
    EXPECT_EQ(result.rows[0]["cones"], 6U);
    EXPECT_EQ(result.rows[0]["all_visible"], false);
    EXPECT_EQ(result.rows[1]["cones"], 20U);
    EXPECT_EQ(result.rows[1]["all_visible"], true);
    EXPECT_DOUBLE_EQ(result.rows[1]["density"], (16 * 5 + 4 * 3) / 20.0);
    EXPECT_GE(result.rows[1]["edges"], 18U + 10U);
    for (const Json& row : result.rows) {
        EXPECT_EQ(row["proven"], true);
        EXPECT_GE(row["nodes"], 1);
        EXPECT_GT(row["cpu_ms"], 0.0);
    }
    EXPECT_THAT(result.table, HasSubstr("4-5"));
}

/// The printed rows have the same optima as the tight ones and a weaker relaxation.
TEST(Formulations, DifferInSizeAndGap) {
    const StudyResult result =
        measured("formulations", "--sizes 6,8,500 --limit 3", scenes_of({"generated:straight"}, 0.2, 20.0));
    ASSERT_EQ(result.rows.size(), 4U);
    for (std::size_t k = 0; k < 4; k += 2) {
        const Json &tight = result.rows[k], &paper = result.rows[k + 1];
        EXPECT_EQ(tight["formulation"], "tight");
        EXPECT_EQ(paper["formulation"], "paper");
        EXPECT_EQ(tight["cones"], k == 0 ? 6 : 8);
        EXPECT_EQ(tight["scenes"], 3);
        EXPECT_EQ(tight["optimal"], paper["optimal"]);
        EXPECT_LE(tight["mean_gap"].get<double>(), paper["mean_gap"].get<double>() + 1e-9);
        EXPECT_LT(tight["entries"], paper["entries"]);
    }
}

TEST(Relaxations, AreEverySolverWithoutProofBesidePathPair) {
    const StudyResult result = measured("relaxations", "--sizes 8,12,500 --time-limit 1000000",
                                        scenes_of({"generated:straight"}, 0.3, 12.0));
    EXPECT_FALSE(result.errors.any_answered_nothing());
    const auto heuristics = std::ranges::count_if(
        rld_solvers(), [](const RldSolverEntry& entry) { return !entry.has(SolverTrait::exact); });
    ASSERT_GT(heuristics, 0);
    const std::size_t of_size = 1 + static_cast<std::size_t>(heuristics);
    ASSERT_EQ(result.rows.size(), 2 * of_size);
    for (std::size_t k = 0; k < result.rows.size(); ++k) {
        const Json &row = result.rows[k], &exact = result.rows[k / of_size * of_size];
        SCOPED_TRACE(row.dump());
        EXPECT_EQ(row["cones"], k < of_size ? 8 : 12);
        EXPECT_EQ(exact["solver"], "path-pair");
        EXPECT_GT(exact["feasible"], 3U);
        EXPECT_EQ(exact["optimal"], exact["feasible"]);
        EXPECT_EQ(exact["worst_gap"], 0.0);
        EXPECT_EQ(row["scenes"], exact["scenes"]);
        EXPECT_EQ(row["feasible"], exact["feasible"]);
        EXPECT_LE(row["optimal"], row["answered"]);
        EXPECT_LE(row["answered"], row["feasible"]);
        if (row.contains("mean_gap")) {
            EXPECT_LE(row["mean_gap"], row["worst_gap"]);
            EXPECT_EQ(row["optimal"] == row["answered"], row["worst_gap"] < 1e-6);
        }
        EXPECT_LE(row["median_ms"], row["p95_ms"]);
        EXPECT_LE(row["p95_ms"], row["worst_ms"]);
    }
}

TEST(Relaxations, AreAccurateWithoutFalseCones) {
    const StudyResult result = measured("relaxations", "--sizes 8 --time-limit 1000000 --limit 2",
                                        scenes_of({"generated:straight"}, 0.0, 12.0));
    for (const Json& row : result.rows) {
        EXPECT_EQ(row["scenes"], 2U);
        // Other heuristics may not find even this lane.
        if (row["solver"] == "path-pair" ||
            std::ranges::count(relaxation_solvers(), row["solver"].get<std::string>(),
                               &RldSolverEntry::name) > 0) {
            EXPECT_EQ(row["accurate"], 1.0) << row;
        }
    }
}

TEST(FrontBeam, AWiderBeamMeetsTheBestLaneAtLeastAsOften) {
    const SceneSet set = scenes_of({"generated:kidney@3"}, 0.4, 12.0);
    const StudyResult result = measured("front-beam", "--beams 1,15 --reference-beam 200", set);
    const std::vector<Json>& rows = result.rows;
    ASSERT_EQ(rows.size(), 3U);
    const auto best = [&](std::size_t k) { return rows[k]["best_score"].get<double>(); };
    // No row has to find all lanes: states with the same front are merged although their lanes differ.
    EXPECT_GE(best(0) + best(1) + best(2), 1.0);
    EXPECT_LT(best(0), best(1));
    EXPECT_LE(best(1), best(2));
    EXPECT_EQ(rows[2]["beam"], 200U);
    for (const Json& row : rows) {
        EXPECT_EQ(row["scenes"], set.scenes.size());
        EXPECT_LE(row["usable"], row["any_usable"]);
        EXPECT_LE(row["first_usable"], row["any_usable"]);
        EXPECT_GT(row["median_ms"], 0.0);
        EXPECT_LE(row["median_ms"], row["worst_ms"]);
    }
    EXPECT_GT(rows[1]["usable"], 0.8);
    EXPECT_GT(rows[1]["iou"], 0.8);
    EXPECT_THROW((void)measured("front-beam", ""), InvalidInput);
    EXPECT_THROW((void)measured("front-beam", "--beams 0", set), InvalidInput);
}

// Eight cones have few lanes, so a complete search ends; within a millionth of a second, no search ends.
TEST(FrontBeam, AProofTakesASearchThatLeavesNothingOut) {
    SceneOptions options{.false_positive_rates = {0.0}, .ranges_m = {30.0}, .every_m = 40.0, .nearest = 8};
    const std::vector<Json> rows = measured("front-beam", "--beams 1 --exhaustive 0.000001,1000000",
                                            make_scene_set({"generated:kidney@3"}, options))
                                       .rows;
    ASSERT_EQ(rows.size(), 4U);
    EXPECT_LT(rows[0]["proven"], 1.0);
    EXPECT_EQ(rows[2]["proven"], 0.0);
    EXPECT_EQ(rows[3]["proven"], 1.0);
    EXPECT_EQ(rows[3]["best_score"], 1.0);
    EXPECT_EQ(rows[3]["beam"], 0U);
    EXPECT_TRUE(rows[3]["drop"].is_null());
}

/// Each objective has its own optimum, on the same scenes, and the lanes of others cost no less.
TEST(Optimality, ComparesLanesWithTheOptimaOfSeveralObjectives) {
    const SceneSet set = scenes_of({"generated:kidney", "generated:straight"}, 0.3, 25.0);
    const char* const options =
        "--params default,shape,learned --strip shipped --beam-width 30 --time-limit 60000 --threads ";
    const StudyResult result = measured("optimality", options + std::string("1"), set);
    ASSERT_EQ(result.rows.size(), 4 * set.scenes.size());
    std::map<std::string, std::size_t> compared;
    for (std::size_t k = 0; k < result.rows.size(); ++k) {
        const Json& row = result.rows[k];
        SCOPED_TRACE(row.dump());
        EXPECT_EQ(row["scene"], set.scenes[k / 4].scene.id);
        EXPECT_EQ(row["costs"], (std::vector<std::string>{"default", "shape", "learned", "strip"}[k % 4]));
        ASSERT_EQ(row["status"], "optimal");
        EXPECT_TRUE(row["optimum"].contains("usable"));
        EXPECT_EQ(row.contains("candidate"), row["feasible_candidates"] > 0U);
        const double optimum = row["optimum"]["objective"];
        for (const char* const name : {"beam", "candidate", "choice", "beside"}) {
            if (!row.contains(name) || !row[name].contains("objective")) continue;
            ++compared[name];
            const double objective = row[name]["objective"];
            EXPECT_GE(objective, optimum - 1e-6);
            EXPECT_DOUBLE_EQ(row[name]["gap"],
                             std::max(0.0, objective - optimum) / std::max(1.0, std::abs(optimum)));
            // What the ranking chose is one of the candidates.
            if (name == std::string("choice")) {
                EXPECT_GE(objective, row["candidate"]["objective"].get<double>() - 1e-9);
            }
        }
        if (row.contains("gap")) {
            EXPECT_EQ(row["gap"], row["candidate"]["gap"]);
            EXPECT_EQ(row["equal"], row["candidate"]["objective"].get<double>() - optimum <= 1e-6);
        }
        // The answers of methods do not know the objective.
        EXPECT_EQ(row["beside"]["iou"], result.rows[k - k % 4]["beside"]["iou"]);
    }
    for (const char* const name : {"beam", "candidate", "choice", "beside"})
        EXPECT_GT(compared[name], result.rows.size() / 2) << name;
    EXPECT_THAT(result.table, testing::ContainsRegex("\nlearned +- +30.0 "));
    EXPECT_LT(result.table.find("\nshape"), result.table.find("\nlearned"));
    EXPECT_EQ(measured("optimality", options + std::string("3"), set).rows, result.rows);
}

/// On a straight lane without false cones all lanes are the optimum, which is the true lane.
TEST(Optimality, FindsTheStraightLaneOptimal) {
    const StudyResult result = measured("optimality", "", straight_set());
    ASSERT_EQ(result.rows.size(), 1U);
    const Json& row = result.rows[0];
    EXPECT_EQ(row["equal"], true);
    EXPECT_LE(row["beam"]["gap"], 1e-6);
    EXPECT_EQ(row["beside"]["iou"], 1.0);
    EXPECT_EQ(row["optimum"]["iou"], 1.0);
    EXPECT_EQ(row["candidate"]["category"], "ground_truth");
    EXPECT_GE(row["candidates"], row["feasible_candidates"]);
    // Equal and gaps; then the scenes, and usable, success and overlap of the four kinds of answers.
    EXPECT_THAT(result.table, testing::ContainsRegex("\ndefault +- +- +1 +100.0 .* 1 +100.0 +0.000 +0.000 "
                                                     "+100.0 / 100.0 +100.0 / 100.0\n"));
    EXPECT_THAT(result.table, testing::ContainsRegex("\ndefault +- +- +1 +- / 100.0 / 100.0 +- / 100.0 "));
}

TEST(Optimality, WantsADetectorThatEnumerates) {
    for (const std::string detector : {"rld-pair", "magic"})
        EXPECT_THROW((void)measured("optimality", "--method " + detector, straight_set()), InvalidInput)
            << detector;
}

}  // namespace
}  // namespace conelane::experiments
