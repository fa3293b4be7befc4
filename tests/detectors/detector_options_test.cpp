// Options of make_detector besides the name: options that a detector does not use are refused; own weights
// are read from a file or from its bytes.

#include "conelane/detectors.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/front_fixture.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/test_paths.hpp"

namespace conelane {
namespace {

std::string refusal(std::string_view detector, const DetectorOptions& options) {
    return conelane::refusal([&] { (void)make_detector(detector, options); });
}

bool starts_with_rld(std::string_view name) {
    return name.starts_with("rld-") && name != "rld-strip";
}

TEST(DetectorOptions, ThatADetectorDoesNotUseAreRefused) {
    for (const DetectorInfo& info : detectors()) {
        SCOPED_TRACE(info.name);
        const std::string name(info.name);
        const std::string by_rld = starts_with_rld(name)
                                       ? "accepted"
                                       : "the detector '" + name + "' does not use it; it takes nearest";
        const std::string for_parameters = refusal(name, {.rld_parameters = RldParameters{}});
        const std::string for_pairing = refusal(name, {.pairing = Pairing::paper});
        if (starts_with_rld(name)) {
            EXPECT_EQ(for_parameters, "accepted");
            EXPECT_EQ(for_pairing, "accepted");
        } else {
            EXPECT_THAT(for_parameters, StartsWith("rld_parameters: " + by_rld));
            EXPECT_THAT(for_pairing, StartsWith("pairing: " + by_rld));
        }
        EXPECT_EQ(refusal(name, {.nearest = 0}), "nearest: must be at least 1");
        EXPECT_EQ(refusal(name, {.nearest = 1}), "accepted");
        if (!name.starts_with("front") && name != "rld-strip") {
            EXPECT_THAT(refusal(name, {.weights = "any.json"}),
                        StartsWith("weights: the detector '" + name + "'"));
        }
    }
}

class OwnWeights : public FileTest {
  protected:
    static std::string fault_of(std::string bytes) {
        return refusal("front", {.weights = WeightsBytes{std::move(bytes)}});
    }

    const std::string shipped_ = text_of(source_directory() / "graph_search" / "weights" / "front.json");
};

double confidence(const DetectorOptions& options) {
    const LaneAnswer answer =
        make_detector("front", options)->detect(tests::straight_front_scene(5), {.time_limit_ms = 60'000.0});
    EXPECT_EQ(answer.status, LaneStatus::found);
    return answer.confidence.value_or(-1.0);
}

TEST_F(OwnWeights, FileAndBytesOfTheShippedOnesAreTheShippedDetector) {
    const double shipped = confidence({});
    EXPECT_EQ(confidence({.weights = file_with(shipped_, "w.json")}), shipped);
    EXPECT_EQ(confidence({.weights = WeightsBytes{shipped_}}), shipped);
}

/// The log odds that a lane is usable decrease by what is subtracted from their bias.
TEST_F(OwnWeights, OthersAreUsed) {
    const std::size_t at = shipped_.find("\"usable_output_bias\"");
    const std::size_t begin = shipped_.find('[', at);
    std::string other = shipped_;
    other.replace(begin, shipped_.find(']', begin) - begin, "[-20");
    EXPECT_LT(confidence({.weights = WeightsBytes{other}}), 0.5 * confidence({}));
}

/// refused_weights.txt has the faults of the file's keys.
TEST_F(OwnWeights, FaultsNameWhatIsWrong) {
    EXPECT_EQ(fault_of(""), "weights: line 1: must be a JSON object, as `conelane train front` writes it");
    EXPECT_EQ(fault_of(with_other(shipped_, "\"version\": 3", "\"version\": 4")),
              "version: must be 1, 2 or 3");
    EXPECT_EQ(fault_of(with_other(shipped_, "\"least_trust\": ", "\"least_trust\": 1")),
              "least_trust: must be in [0, 1]");
    EXPECT_THAT(fault_of(shipped_ + "{}"), HasSubstr("there is more after the object"));
    EXPECT_THAT(fault_of("{\"training\": " + std::string(100'000, '[')), HasSubstr("nested too deep"));
    const std::string nowhere = path("nowhere.json").string();
    EXPECT_EQ(refusal("front", {.weights = nowhere}), "weights: " + nowhere + ": cannot be read");
    EXPECT_EQ(refusal("front-warm", {.weights = file_with("{}", "w.json")}),
              "weights: " + path("w.json").string() + ": version: is missing");
}

/// Wherever the file is cut, the reader notices it.
TEST_F(OwnWeights, TruncatedFilesAreRefused) {
    const std::size_t whole = shipped_.find_last_of('}');
    for (std::size_t size = 0; size <= whole; size += 997)
        EXPECT_NE(fault_of(shipped_.substr(0, size)), "accepted") << size;
    EXPECT_THAT(fault_of(shipped_.substr(0, whole)), HasSubstr("the file ends in the middle"));
    EXPECT_EQ(fault_of(shipped_.substr(0, whole + 1)), "accepted");
}

}  // namespace
}  // namespace conelane
