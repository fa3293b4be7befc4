#pragma once

#include "evaluation/formats/lane_file.hpp"
#include "tests/support/program_fixture.hpp"

namespace conelane {

/// The program, and scenes of a generated track for it.
class Program : public ProgramFixture {
  protected:
    void make_scenes(const std::string& options, const std::string& name = "s") {
        const Outcome outcome = run("scenes --tracks generated:kidney --every 20 --seed 3 " + options +
                                    " --out " + name + ".scenes.jsonl");
        ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    }
};

/// The scene "a", of two cones.
inline constexpr const char* kScene =
    R"({"id": "a", "pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [{"id": 1, "x": 1, "y": 2}, {"id": 2, "x": 4, "y": 2}]})";

/// Lanes files are equal, except for the times.
inline std::vector<Lane> lanes_in(const std::filesystem::path& file) {
    return mapped(read_lanes(file), [](const LaneRecord& record) { return record.answer.lane; });
}

}  // namespace conelane
