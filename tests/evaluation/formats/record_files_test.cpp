#include "evaluation/formats/lane_file.hpp"
#include "evaluation/formats/solution_file.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/refusal.hpp"

namespace conelane {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class LaneFileTest : public FileTest {
  protected:
    [[nodiscard]] static std::string lane(const std::string& status, const std::string& left,
                                          const std::string& rest = "") {
        return R"({"scene": "a", "method": "clc", "status": ")" + status + R"(", "left": )" + left +
               R"(, "right": [], "latency_ms": 1.73)" + rest + "}\n";
    }
};

TEST_F(LaneFileTest, EverythingADetectorKnowsSurvivesARoundTrip) {
    LaneRecord full{"a", "clc", {}, 1.73, 12, true};
    full.answer.status = LaneStatus::found;
    full.answer.lane = {{49, 17}, {5, 10}, true};
    full.answer.confidence = 0.5;
    full.answer.trusted_m = 12.5;
    full.answer.optimality = Optimality{-3.5, -4.0, false};
    full.answer.enumeration = Enumeration{17, true, {{{{49}, {5}, false}, 3}, {{{1, 2}, {3}, true}, 4}}};
    LaneRecord failed{"b", "clc", {}, 0.0, {}};
    failed.answer.status = LaneStatus::error;
    failed.answer.message = "out of memory";
    write_lanes(path("l"), std::vector{full, failed});
    EXPECT_EQ(text_of(path("l")),
              R"({"scene":"a","method":"clc","status":"found","left":[49,17],"right":[5,10],"closed":true,)"
              R"("latency_ms":1.73,"confidence":0.5,"trusted_m":12.5,)"
              R"("objective":-3.5,"bound":-4.0,"optimal":false,"iterations":17,"complete":true,"candidates":)"
              R"([{"left":[49],"right":[5],"iteration":3},)"
              R"({"left":[1,2],"right":[3],"closed":true,"iteration":4}],"nearest":12,"checked":true})"
              "\n"
              R"({"scene":"b","method":"clc","status":"error","left":[],"right":[],"closed":false,)"
              R"("latency_ms":0.0,"message":"out of memory"})"
              "\n");
    // Since the text shows every value, values that are read wrong would change it.
    const std::string written = text_of(path("l"));
    write_lanes(path("l"), read_lanes(path("l")));
    EXPECT_EQ(text_of(path("l")), written);
}

TEST_F(LaneFileTest, ABoundThatProvesNothingIsLeftOut) {
    LaneRecord record{"a", "m", {}, 1.0, {}};
    record.answer.status = LaneStatus::found;
    record.answer.optimality = Optimality{2.0, -kInfinity, false};
    write_lanes(path("l"), std::vector{record});
    EXPECT_EQ(text_of(path("l")).find("bound"), std::string::npos);
    EXPECT_EQ(read_lanes(path("l")).front().answer.optimality->bound, -kInfinity);
    record.answer.optimality->bound = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(write_lanes(path("l"), std::vector{record}), InvalidInput);
}

/// Version 0.1 had one limit only.
TEST_F(LaneFileTest, ReadsTheOldNameOfAStop) {
    const std::vector<LaneRecord> read =
        read_lanes(file_with(lane("time_limit", "[]") + lane("stopped", "[]", R"(, "nearest": 6)") +
                             lane("stopped", "[]", R"(, "stopped_by": "iterations", "nearest": 7)")));
    ASSERT_EQ(read.size(), 3u);
    EXPECT_EQ(read[0].answer.status, LaneStatus::stopped);
    EXPECT_EQ(read[0].answer.stopped_by, StopReason::time);
    EXPECT_FALSE(read[1].answer.stopped_by.has_value());
    EXPECT_EQ(read[2].answer.stopped_by, StopReason::iterations);
    EXPECT_TRUE(read_lanes(file_with("")).empty());
}

class SolutionFileTest : public FileTest {
  protected:
    [[nodiscard]] static std::string solution(const std::string& status, const std::string& edges) {
        return R"({"scene": "a", "solver": "cbc", "formulation": "tight", "status": ")" + status +
               R"(", "edges": )" + edges + R"(, "build_ms": 0.41, "solve_ms": 2.9})" + "\n";
    }
};

TEST_F(SolutionFileTest, RoundTrip) {
    const SolutionRecord optimal{"a", "cbc", "tight", "optimal", "", {{49, 17}, {5, 10}}, -3.2187, -3.2187,
                                 0,   0.41,  2.9,     {},        {}};
    const SolutionRecord failed{"b",        "cbc", "tight", "error", "no licence", {}, {},
                                -kInfinity, {},    0.5,     0.0,     {},           {}};
    const SolutionRecord stopped{"c", "cbc", "tight", "stopped",        "", {}, {}, {},
                                 {},  0.5,   0.0,     StopReason::time, 12U};
    write_solutions(path("s"), std::vector{optimal, failed, stopped});
    EXPECT_EQ(
        text_of(path("s")),
        R"({"scene":"a","solver":"cbc","formulation":"tight","status":"optimal","edges":[[49,17],[5,10]],)"
        R"("objective":-3.2187,"bound":-3.2187,"nodes":0,"build_ms":0.41,"solve_ms":2.9})"
        "\n"
        R"({"scene":"b","solver":"cbc","formulation":"tight","status":"error","edges":[],)"
        R"("build_ms":0.5,"solve_ms":0.0,"message":"no licence"})"
        "\n"
        R"({"scene":"c","solver":"cbc","formulation":"tight","status":"stopped","edges":[],)"
        R"("build_ms":0.5,"solve_ms":0.0,"stopped_by":"time","nearest":12})"
        "\n");
    const std::string written = text_of(path("s"));
    write_solutions(path("s"), read_solutions(path("s")));
    EXPECT_EQ(text_of(path("s")), written);
}

/// Up to version 0.5, the word was that of the most frequent limit, even if the memory was the limit.
TEST_F(SolutionFileTest, ReadsTheOldNameOfAStop) {
    std::string by_memory = solution("time_limit", "[]");
    by_memory.replace(by_memory.find("\"tight\""), 7, "\"paper\", \"stopped_by\": \"memory\"");
    const std::vector<SolutionRecord> read =
        read_solutions(file_with(solution("time_limit", "[]") + by_memory, "s"));
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read[0].status, "stopped");
    EXPECT_FALSE(read[0].stopped_by.has_value());
    EXPECT_EQ(read[1].status, "stopped");
    EXPECT_EQ(read[1].stopped_by, StopReason::memory);
}

class ParameterTagTest : public FileTest {};

/// A name is for people. Values distinguish parameters, and a file may be replaced under its name.
TEST_F(ParameterTagTest, DistinguishesParametersByTheirValues) {
    RldParameters parameters;
    const ParameterTag made = tag_of("folder/own.json", parameters);
    EXPECT_EQ(made.name, "own.json");
    EXPECT_EQ(tag_of("", parameters).name, "default");
    EXPECT_EQ(tag_of("", parameters).hash, made.hash);
    std::set<std::string> hashes{made.hash.value()};
    for (const auto& fields : {rld_parameter_fields(), rld_extra_fields()}) {
        for (const RldParameterField& field : fields) {
            RldParameters other;
            other.*field.value += 0.001;
            EXPECT_TRUE(hashes.insert(tag_of("", other).hash.value()).second) << field.key;
        }
    }
    parameters.use_confidence = true;
    EXPECT_TRUE(hashes.insert(tag_of("", parameters).hash.value()).second);
    parameters.forbid_crossing = true;
    EXPECT_TRUE(hashes.insert(tag_of("", parameters).hash.value()).second);
    const ParameterTag now = tag_of("elsewhere/own.json", parameters);
    EXPECT_EQ(error_of([&] {
                  require_same_basis({made, {}}, {now, {}}, "f", 3);
              }),
              "f:3: parameters: made by other values than 'own.json' has now");
}

TEST_F(ParameterTagTest, AMissingValueIsNoDifference) {
    const ParameterTag now = tag_of("", {});
    EXPECT_NO_THROW(require_same_basis({{}, {}}, {now, 12U}, "f", 1)) << "a file of an earlier version";
    EXPECT_NO_THROW(require_same_basis({now, 12U}, {now, {}}, "f", 1));
    EXPECT_EQ(error_of([&] {
                  require_same_basis({now, {}}, {now, 12U}, "f", 1);
              }),
              "f:1: nearest: made among all cones, checked among the 12 nearest cones: leave out --nearest");
    EXPECT_EQ(error_of([&] {
                  require_same_basis({{}, 8U}, {now, 12U}, "f", 1);
              }),
              "f:1: nearest: made among the 8 nearest cones, checked among the 12 nearest cones: leave out "
              "--nearest");
}

class ParameterFileTest : public FileTest {};

TEST_F(ParameterFileTest, RoundTripAndDefaultPairing) {
    RldParameters parameters;
    double step = 0.001;
    for (const RldParameterField& field : rld_parameter_fields()) {
        parameters.*field.value -= step += 0.001;  // different values, so that exchanged keys are noticed
    }
    parameters.pairing = Pairing::paper;
    write_rld_parameters(path("p"), parameters);
    const RldParameters read = read_rld_parameters(path("p"));
    for (const RldParameterField& field : rld_parameter_fields())
        EXPECT_EQ(read.*field.value, parameters.*field.value) << field.key;
    EXPECT_EQ(read.pairing, Pairing::paper);

    std::string text = text_of(path("p"));
    const std::size_t pairing = text.find(",\n  \"pairing\"");
    ASSERT_NE(pairing, std::string::npos);
    EXPECT_EQ(read_rld_parameters(file_with(text.substr(0, pairing) + "}")).pairing, Pairing::near_far);
}

/// A file contains the extras that are on; missing extras are off.
TEST_F(ParameterFileTest, ExtrasAreOptional) {
    write_rld_parameters(path("p"), RldParameters{});
    for (const RldParameterField& field : rld_extra_fields()) {
        EXPECT_EQ(text_of(path("p")).find(field.key), std::string::npos) << field.key;
        EXPECT_EQ(read_rld_parameters(path("p")).*field.value, RldParameters{}.*field.value) << field.key;
    }

    RldParameters parameters;
    double step = 0.25;
    for (const RldParameterField& field : rld_extra_fields()) parameters.*field.value += step += 0.125;
    parameters.use_confidence = true;
    parameters.forbid_crossing = true;
    write_rld_parameters(path("p"), parameters);
    const RldParameters read = read_rld_parameters(path("p"));
    for (const RldParameterField& field : rld_extra_fields())
        EXPECT_EQ(read.*field.value, parameters.*field.value) << field.key;
    EXPECT_TRUE(read.use_confidence);
    EXPECT_TRUE(read.forbid_crossing);

    std::string text = text_of(path("p"));
    text.replace(text.find("\"use_confidence\": 1"), 19, "\"use_confidence\": 2");
    EXPECT_EQ(error_of([&] { static_cast<void>(read_rld_parameters(file_with(text, "p"))); }),
              "p: use_confidence: must be 0 or 1");
    parameters.facing_distance_m = 0.0009;
    EXPECT_THROW(validate(parameters), InvalidInput);
    parameters.facing_distance_m = 0.001;
    EXPECT_NO_THROW(validate(parameters));
}

TEST_F(ParameterFileTest, NamesBadParameters) {
    write_rld_parameters(path("p"), RldParameters{});
    const std::string good = text_of(path("p"));
    const auto error_with = [&](const std::string& from, const std::string& to) {
        const auto file = file_with(with_other(good, from, to), "p");
        return error_of([&] { (void)read_rld_parameters(file); });
    };
    EXPECT_EQ(error_with("\"d_t\"", "\"other\""), "p: d_t: is missing");
    EXPECT_EQ(error_with("\"near_far\"", "\"far\""), "p: pairing: must be one of near_far, paper");
    EXPECT_EQ(error_with("{", "{\"w_bb\": 1,"), "p: w_bb: is not a key here; w_b is");
    EXPECT_EQ(error_with("{", "{\"Use_Confidence\": 1,"),
              "p: Use_Confidence: is not a key here; use_confidence is");
    EXPECT_THAT(error_with("{", "{\"wings\": 1,"), HasSubstr("p: wings: is not a key here, only d_e, d_t, "));
    EXPECT_EQ(error_with("1.7", "\"1.7\""), "p: d_t: must be a number");
    EXPECT_EQ(error_with("1.7", "NaN"), "p:3: d_t: must be a finite number");
    EXPECT_EQ(error_with("1.7", "-1"), "p: d_t: must be in [0.001000, 1000.000000] m");
    EXPECT_EQ(error_with("}", ""), "p:19: pairing: the JSON ends too early");
}

}  // namespace
}  // namespace conelane
