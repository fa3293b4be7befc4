#pragma once

#include "conelane/scene.hpp"
#include "evaluation/formats/lane_file.hpp"
#include "evaluation/outside/child_process.hpp"

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace conelane {

/// Limits for waiting for a program from outside [ms].
struct OutsideLimits {
    double answer_ms = 2000.0;
    double start_ms = 20000.0;  ///< from its start to its first answer, which is not counted
    double end_ms = 1000.0;     ///< from the end of its input to its own end
    /// After this many failures in a row, or failures of this duration, a program is not asked for the rest
    /// of the lap.
    int failures = 20;
    double lost_ms = 20000.0;
};

/// A program that answers scene after scene over standard input and output (see
/// docs/from-outside.md). Each scene gets an answer: one of status error if the program crashed, was
/// late, wrote an invalid line or named unknown cones. It is then started again for the next scene.
///
/// After each start the current scene is asked once without timing, so no latency includes the loading of
/// code, and a reset follows.
class OutsideProgram {
  public:
    OutsideProgram(std::string name, std::string command, const OutsideLimits& limits = {});
    ~OutsideProgram();
    OutsideProgram(const OutsideProgram&) = delete;
    OutsideProgram& operator=(const OutsideProgram&) = delete;

    /// Latency is the round trip: from the scene in memory to the lane in memory. A scene that was not asked
    /// counts with the limit.
    [[nodiscard]] LaneRecord answer(const Scene& scene);
    /// Another lap begins.
    void reset();

  private:
    /// An answer, or the reason of a failure.
    struct Attempt {
        std::optional<LaneRecord> record;
        std::string fault;
    };
    Attempt ask(const Scene& scene, double limit_ms);
    std::string start(const Scene& scene);
    void count_failure(double lost_ms);
    [[nodiscard]] LaneRecord error(const Scene& scene, double latency_ms, const std::string& message) const;

    std::string name_;
    std::string command_;
    OutsideLimits limits_;
    std::unique_ptr<ChildProcess> child_;
    std::int64_t asked_ = 0;  ///< running number, used as the scene id that the program sees
    int failures_ = 0;        ///< since its last answer
    double lost_ms_ = 0.0;    ///< time lost by these failures
    std::string last_fault_;
    bool has_answered_ = false;
    bool is_left_alone_ = false;
    int laps_to_wait_ = 0;  ///< number of laps until it is tried again
    int next_wait_ = 1;     ///< doubles with each lap in which it fails again
};

/// The processes of one program: as many as threads use at a time.
class OutsideProgramPool {
  public:
    OutsideProgramPool(std::string name, std::string command)
        : name_(std::move(name)), command_(std::move(command)) {}

    /// An unused process; it is told of the next lap.
    [[nodiscard]] std::unique_ptr<OutsideProgram> take();
    void give_back(std::unique_ptr<OutsideProgram> program);

  private:
    std::string name_;
    std::string command_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<OutsideProgram>> idle_;
};

}  // namespace conelane
