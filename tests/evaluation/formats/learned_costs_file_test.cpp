#include "evaluation/formats/learned_costs_file.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/rld_parameters.hpp"
#include "detectors/parameters/learned_costs_reader.hpp"
#include "evaluation/formats/parameter_file.hpp"
#include "evaluation/formats/parameter_tag.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/learned_costs.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

class LearnedCostsFileTest : public FileTest {};

std::string fault_of(const std::string& text) {
    return refusal([&] { (void)parse_learned_costs(text); });
}

TEST_F(LearnedCostsFileTest, KeepsEveryBit) {
    for (const std::size_t units : {0U, 4U}) {
        const auto costs = tests::random_learned_costs(7, units);
        const std::string text = learned_costs_json(*costs, R"({"seed": 3})");
        EXPECT_THAT(text, testing::HasSubstr(R"("seed": 3)"));
        EXPECT_TRUE(*parse_learned_costs(text) == *costs);
    }
    EXPECT_THROW((void)learned_costs_json(LearnedCosts{}, "{}"), InvalidInput);
    EXPECT_THROW((void)learned_costs_json(LearnedCosts::zero(), "[]"), InvalidInput);
}

TEST_F(LearnedCostsFileTest, ABadFileIsOneClearError) {
    const std::string text = learned_costs_json(LearnedCosts::zero(1), "{}");
    EXPECT_EQ(fault_of(""), "weights: line 1: must be a JSON object, as `conelane train rld` writes it");
    EXPECT_EQ(fault_of(with_other(text, "\"version\": 1", "\"version\": 2")), "version: must be 1");
    EXPECT_EQ(fault_of(with_other(text, "\"version\": 1,", "")), "version: is missing");
    EXPECT_EQ(
        fault_of(with_other(text, "\"spacing\"", "\"spaces\"")),
        "features: 'edge' has 'spaces' at place 1, unlike the library: the weights are of another version");
    EXPECT_EQ(fault_of(with_other(text, "\"far_end\":[", "\"end\":[")),
              "features: 'end' is not a list of the library");
    EXPECT_EQ(fault_of(with_other(text, "\"turn_output\": [0]", "\"turn_output\": [0,0]")),
              "turn.hidden: must have 28 numbers, not 14");
    EXPECT_EQ(fault_of(with_other(text, "\"turn_output\": [0]", "\"turn_output\": [true]")),
              "turn_output: number 0 (from 0) is not a number");
    EXPECT_EQ(fault_of(with_other(text, "\"turn_output\": [0]", "\"turn_output\": [1e400]")),
              "turn.output: must hold numbers between -1e6 and 1e6");
    EXPECT_EQ(fault_of(with_other(text, "\"turn_output\"", "\"turns_output\"")),
              "turns_output: is not a key of learned costs");
    EXPECT_EQ(fault_of(with_other(text, "\"turn_output\": [0],", "")), "turn_output: is missing");
}

TEST_F(LearnedCostsFileTest, IsNamedByParameters) {
    RldParameters parameters;
    parameters.d_gap = 9.0;
    parameters.learned_costs = tests::random_learned_costs(2, 3);
    write_rld_parameters(path("own.json"), parameters, R"({"seed": 5})");
    EXPECT_THAT(text_of(path("own.json")), testing::HasSubstr(R"("learned_costs": "own.weights.json")"));
    EXPECT_THAT(text_of(path("own.weights.json")), testing::HasSubstr(R"("seed": 5)"));
    const RldParameters read = read_rld_parameters(path("own.json"));
    ASSERT_TRUE(read.learned_costs);
    EXPECT_TRUE(*read.learned_costs == *parameters.learned_costs);
    EXPECT_EQ(tag_of("own.json", read), tag_of("own.json", parameters));
    RldParameters others = parameters;
    others.learned_costs = tests::random_learned_costs(3, 3);
    EXPECT_NE(tag_of("own.json", others).hash, tag_of("own.json", parameters).hash);
    others.learned_costs.reset();
    EXPECT_NE(tag_of("own.json", others).hash, tag_of("own.json", parameters).hash);

    const auto error_with = [&](const std::string& weights) {
        if (weights.empty()) {
            std::filesystem::remove(path("own.weights.json"));
        } else {
            std::ofstream(path("own.weights.json")) << weights;
        }
        return error_of([&] { static_cast<void>(read_rld_parameters(path("own.json"))); });
    };
    EXPECT_THAT(error_with("{}"), testing::AllOf(testing::StartsWith("own.json: learned_costs: weights: "),
                                                 testing::HasSubstr("own.weights.json: "),
                                                 testing::EndsWith("version: is missing")));
    EXPECT_THAT(error_with(""), testing::EndsWith("own.weights.json: cannot be read"));
}

}  // namespace
}  // namespace conelane
