// `conelane instances`: files that other solvers can read, and optima that two engines have proved.

#include "conelane/invalid_input.hpp"
#include "conelane/solve_scene.hpp"
#include "experiments/instances/instance_library.hpp"
#include "solvers/milp/milp_solver.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/program_fixture.hpp"
#include "tests/support/slowness.hpp"

#include <zlib.h>

namespace conelane::experiments {
namespace {

using testing::HasSubstr;

constexpr double kSameObjective = 1e-6;

/// The lines of a .solu file by name: `=opt=` and so on, and the value.
struct Known {
    std::string mark;
    double value = 0.0;
};
std::map<std::string, Known> read_solu(const std::filesystem::path& file) {
    std::ifstream in(file);
    EXPECT_TRUE(in) << file;
    std::map<std::string, Known> all;
    Known known;
    for (std::string name; in >> known.mark >> name;) {
        if (known.mark != "=inf=") in >> known.value;
        if (known.mark != "=bestdual=") all[name] = known;
    }
    return all;
}

std::set<std::string> line_set_of(const std::filesystem::path& file) {
    std::ifstream in(file);
    EXPECT_TRUE(in) << file;
    std::set<std::string> all;
    for (std::string line; std::getline(in, line);) all.insert(line);
    return all;
}

std::string unpacked(const std::filesystem::path& file) {
    gzFile in = gzopen(file.c_str(), "rb");
    EXPECT_NE(in, nullptr) << file;
    std::string text;
    std::array<char, 4096> block{};
    for (int read = 0; (read = gzread(in, block.data(), block.size())) > 0;) {
        text.append(block.data(), static_cast<std::size_t>(read));
    }
    EXPECT_EQ(gzclose(in), Z_OK);
    return text;
}

const std::filesystem::path kStored = source_directory() / "tests/experiments/instances/library";

/// The options that made tests/experiments/instances/library/ (see README.md there), apart from its selection
/// of scenes.
InstanceOptions slice_of_stored() {
    InstanceOptions options;
    options.tracks = {"generated:straight", "generated:circle", "generated:curvy"};
    options.scenes.false_positive_rates = {0.1667, 0.5};
    options.scenes.ranges_m = {30.0};
    options.scenes.every_m = 120.0;
    options.scenes.seed = 7;
    options.nearest = {12};
    return options;
}

class Instances : public ProgramFixture {};

TEST_F(Instances, ASliceOfTheStoredLibraryIsTheSameAgain) {
    const InstanceOptions options = slice_of_stored();
    const std::vector<InstanceScene> scenes = instance_scenes(options);
    const InstanceCounts counts = write_instances(path("made"), scenes, options);
    EXPECT_EQ(counts.written, 2 * scenes.size());
    EXPECT_EQ(counts.optimal, counts.written) << "twelve cones take milliseconds";
    const std::set<std::string> stored_list = line_set_of(kStored / "conelane.test");
    for (const std::string& file : line_set_of(path("made") / "conelane.test")) {
        EXPECT_TRUE(stored_list.contains(file)) << file;
        EXPECT_TRUE(std::filesystem::exists(path("made") / file)) << file;
    }
    std::map<std::string, Known> stored = read_solu(kStored / "conelane.solu");
    const std::map<std::string, Known> made = read_solu(path("made") / "conelane.solu");
    ASSERT_EQ(made.size(), counts.written);
    for (const auto& [name, known] : made) {
        EXPECT_EQ(known.mark, "=opt=") << name;
        EXPECT_EQ(stored[name].mark, "=opt=") << name;
        EXPECT_NEAR(known.value, stored[name].value, kSameObjective) << name;
    }
}

/// For a stored open instance, no search may prove that its best objective is impossible.
TEST_F(Instances, NoBoundOfAHardSceneIsAboveTheBestKnownLaneGraph) {
    InstanceOptions options;
    options.tracks = {"generated:legs", "generated:infield"};
    options.scenes.false_positive_rates = {0.5};
    options.scenes.ranges_m = {30.0};
    options.scenes.every_m = 60.0;
    options.scenes.seed = 7;
    options.nearest = {std::nullopt};
    const std::map<std::string, Known> stored = read_solu(kStored / "hard.solu");
    const auto solver = make_path_pair_solver();
    int compared = 0;
    for (const InstanceScene& set : instance_scenes(options)) {
        const auto known = stored.find(set.name + std::string(ending_of(Formulation::tight)));
        if (known == stored.end()) continue;
        SCOPED_TRACE(set.name);
        EXPECT_EQ(known->second.mark, "=best=");
        RldReport report;
        for (double limit_ms = 50.0; !report.bound && limit_ms < 1e5; limit_ms *= 2.0)
            report = solve_scene(*solver, set.scene, RldParameters{}, {.limits = {limit_ms}}).report;
        ASSERT_NE(report.status, SolveStatus::error) << report.message;
        ASSERT_NE(report.status, SolveStatus::infeasible);
        EXPECT_LE(report.bound.value(), known->second.value + kSameObjective);
        ++compared;
    }
    EXPECT_EQ(compared, 4);
}

/// Four gates ahead of the car, and far to the left ten cones in a ring.
Scene lane_and_ring() {
    Scene scene;
    for (int i = 0; i < 4; ++i) {
        scene.cones.push_back({i, {1.0 + 3.2 * i, 1.8}});
        scene.cones.push_back({10 + i, {1.2 + 3.2 * i, -1.8}});
    }
    for (int i = 0; i < 10; ++i) {
        const double angle_rad = 0.2 * std::numbers::pi * i;
        scene.cones.push_back({20 + i, {6.0 + 5.2 * std::cos(angle_rad), 25.0 + 5.2 * std::sin(angle_rad)}});
    }
    return scene;
}

// Without the rows of (5), the program of a scene also takes the ring's edges, which are not in a lane.
TEST_F(Instances, RowsAreAddedUntilTheOptimumIsThatOfTheScene) {
    const std::optional<Instance> instance =
        make_instance(lane_and_ring(), "ring", Formulation::tight, RldParameters{}, 10'000.0);
    ASSERT_TRUE(instance);
    ASSERT_TRUE(instance->optimum.is_optimal());
    EXPECT_FALSE(instance->has_flow);
    const MilpReport report = kClpBb.load(instance->program)->solve({});
    ASSERT_EQ(report.status, SolveStatus::optimal);
    EXPECT_NEAR(*report.bound, *instance->optimum.best, kSameObjective);
    BinaryProgram bare = instance->program;
    std::size_t rows = bare.rows.size();
    while (bare.rows[rows - 1].label.family == "separated") --rows;
    ASSERT_LT(rows, bare.rows.size());
    bare.truncate_rows(rows);
    const MilpReport relaxed = kClpBb.load(bare)->solve({});
    ASSERT_EQ(relaxed.status, SolveStatus::optimal);
    EXPECT_LT(*relaxed.bound, *instance->optimum.best - 1.0);
}

// The search has no time, so the file has all rows: another engine finds the scene's optimum in it.
TEST_F(Instances, AFileWithoutAKnownOptimumIsTheWholeProblem) {
    for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
        const std::optional<Instance> instance =
            make_instance(lane_and_ring(), "ring", formulation, RldParameters{}, 1e-6);
        ASSERT_TRUE(instance);
        EXPECT_TRUE(instance->has_flow);
        EXPECT_EQ(instance->optimum.first(), nullptr);
        const MilpReport report = kCbcMain.load(instance->program)->solve({});
        ASSERT_EQ(report.status, SolveStatus::optimal);
        const auto exact = solve_scene(*make_path_pair_solver(), lane_and_ring(), RldParameters{}, {}).report;
        ASSERT_EQ(exact.status, SolveStatus::optimal);
        EXPECT_NEAR(report.bound.value(), exact.objective.value(), kSameObjective);
    }
}

TEST_F(Instances, TwoConeSetsMayNotHaveOneFileName) {
    const std::vector<InstanceScene> twice(2, InstanceScene{.name = "a_b_n12", .scene = lane_and_ring()});
    EXPECT_THROW((void)write_instances(path("made"), twice, slice_of_stored()), InvalidInput);
}

TEST_F(Instances, AnUnfinishedProgramIsOpen) {
    InstanceOptions options = slice_of_stored();
    options.time_limit_ms = 1e-6;
    std::vector<InstanceScene> scenes = instance_scenes(options);
    scenes.resize(1);
    const InstanceCounts counts = write_instances(path("made"), scenes, options);
    EXPECT_EQ(counts.written, 2u);
    EXPECT_EQ(counts.optimal + counts.infeasible, 0u);
    for (const auto& [name, known] : read_solu(path("made") / "conelane.solu")) {
        EXPECT_NE(known.mark, "=opt=") << name;
    }
}

/// Path-pair needs less than a millisecond, CBC more: neither count may call the same programs open and not
/// open.
TEST_F(Instances, OpenProgramsAreCountedInOneWay) {
    const Outcome outcome =
        run("instances --tracks generated:curvy --fp 0.5 --every 1000 --nearest 12 --seed 3 --time-limit 2 "
            "--out made");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    std::size_t of_two = 0, of_classes = 0, both = 0, none = 0, one = 0, left_out = 0, easy = 0, hard = 0;
    ASSERT_EQ(
        std::sscanf(outcome.output.c_str(),
                    "2 programs in made: %zu optima and %zu infeasible by both path-pair and CBC, %zu proven "
                    "by one of them alone, %zu open; %zu left out, too large or without an edge classes: %zu "
                    "easy, %zu hard, %zu open",
                    &both, &none, &one, &of_two, &left_out, &easy, &hard, &of_classes),
        8)
        << outcome.output;
    EXPECT_EQ(of_two, of_classes);
    EXPECT_EQ(both + none + one + of_two, 2U);
    EXPECT_EQ(easy + hard + of_classes, 2U);
}

TEST_F(Instances, TheProgramWritesFilesThatUnpack) {
    const std::string arguments =
        " --tracks generated:curvy --fp 0.5 --every 1000 --nearest 12,16 --seed 3 --out ";
    const Outcome outcome = run_well("instances" + arguments + "made");
    EXPECT_THAT(outcome.output, HasSubstr("4 programs in made: "));
    const std::string name = "curvy_pose_0000_fp_0.50_range_30_n12.tight";
    const std::string text = unpacked(path("made") / (name + ".mps.gz"));
    EXPECT_THAT(text, HasSubstr("NAME " + name + " FREE\nROWS\n"));
    EXPECT_TRUE(text.ends_with("ENDATA\n"));
    EXPECT_EQ(line_set_of(path("made") / "conelane.test").size(), 4u);
}

TEST_F(Instances, EachObjectiveHasProgramsAndLinesInTheIndex) {
    const Outcome outcome = run_well(
        "instances --tracks generated:curvy --fp 0.5 --every 1000 --nearest 12,all --limit 1 --seed 3 "
        "--params default,shape --pairing near_far,paper --max-printed-cones 20 --out made");
    EXPECT_THAT(outcome.output, HasSubstr("12 programs in made: "));
    const std::string scene = "curvy_pose_0000_fp_0.50_range_30_";
    std::set<std::string> wanted;
    for (const std::string costs : {"", "_shape", "_paper", "_shape_paper"}) {
        wanted.insert(scene + "n12" + costs + ".printed.mps.gz");
        wanted.insert(scene + "n12" + costs + ".tight.mps.gz");
        wanted.insert(scene + "all" + costs + ".tight.mps.gz");
    }
    EXPECT_EQ(line_set_of(path("made") / "conelane.test"), wanted);

    std::ifstream index(path("made") / "index.csv");
    std::string line;
    std::getline(index, line);
    EXPECT_TRUE(line.starts_with("file,track,split,condition,")) << line;
    EXPECT_TRUE(line.ends_with(",min_cost,mean_cost")) << line;
    const auto columns = std::ranges::count(line, ',');
    std::set<std::string> listed;
    while (std::getline(index, line)) {
        EXPECT_EQ(std::ranges::count(line, ','), columns) << line;
        EXPECT_THAT(line, HasSubstr(",curvy,tuning,"));
        listed.insert(line.substr(0, line.find(',')));
        const std::string name = line.substr(0, line.find(".mps.gz"));
        EXPECT_EQ((line.find(",shape,") != std::string::npos), (name.find("_shape") != std::string::npos))
            << line;
        EXPECT_EQ((line.find(",paper,") != std::string::npos), (name.find("_paper") != std::string::npos))
            << line;
        EXPECT_EQ((line.find(",all,") != std::string::npos), (name.find("_all") != std::string::npos))
            << line;
    }
    EXPECT_EQ(listed, wanted);
}

TEST_F(Instances, AClassIsOfTheBestEngine) {
    const auto with = [](std::vector<Proof> proofs) {
        return KnownOptimum{.best = {}, .bound = {}, .proofs = std::move(proofs)};
    };
    EXPECT_EQ(class_of(with({{"path-pair", 900.0}, {"cbc", 1100.0}})), InstanceClass::easy);
    EXPECT_EQ(class_of(with({{"cbc", 900.0}})), InstanceClass::easy);
    EXPECT_EQ(class_of(with({{"path-pair", 1100.0}, {"cbc", 1200.0}})), InstanceClass::hard);
    EXPECT_EQ(class_of(with({})), InstanceClass::open);
    EXPECT_EQ(with({{"path-pair", 3.0}, {"cbc", 2.0}}).first()->engine, "cbc");
}

TEST_F(Instances, CoursesThatWereInViewAreNotHeldOut) {
    for (const char* track : {"fsd_1", "curvy", "hairpins@3", "pacsim_FSG19", "eufs_comp_2021"})
        EXPECT_TRUE(is_tuning_course(track)) << track;
    for (const char* track : {"eufs_track_1", "eufs_bone", "ftlog_skidpad", "curvy_two"})
        EXPECT_FALSE(is_tuning_course(track)) << track;
}

TEST_F(Instances, BadOptionsAreRefused) {
    expect_refused("instances --nearest twelve --out made", {"--nearest", "twelve"});
    expect_refused("instances --nearest 12,12 --out made", {"--nearest", "12"});
    expect_refused("instances --params default,default --out made", {"--params", "default"});
    expect_refused("instances --pairing both --out made", {"--pairing", "both"});
    expect_refused("instances --tracks generated:nowhere --out made", {"nowhere"});
    std::ofstream(path("file")) << "x";
    expect_refused("instances --out file", {"file"});
}

}  // namespace
}  // namespace conelane::experiments
