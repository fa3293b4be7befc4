#pragma once

#include "evaluation/formats/scene_set.hpp"
#include "experiments/methods/method.hpp"

namespace conelane::experiments {

/// A lanes file that grows while a detector runs. Until it is complete its name is FILE.part; a stopped run
/// finds its answers there.
class LaneLog {
  public:
    /// Opens FILE.part, and drops an unfinished last line. Throws InputError.
    explicit LaneLog(const std::filesystem::path& file);

    /// Whole lines of an earlier run.
    [[nodiscard]] std::size_t stored() const { return stored_; }
    /// Keeps the first `count` of them. Precondition: count <= stored(), nothing appended yet.
    void keep(std::size_t count);

    /// The line is on the disk when this returns. Throws InputError if the disk is full.
    void append(std::span<const LaneRecord> records);

    /// Gives the file its name. Throws InputError.
    void finish();

  private:
    std::filesystem::path file_;
    std::filesystem::path part_;
    std::size_t stored_ = 0;
    OutputStream stream_;
};

/// Gets the records of each lap, in the order of the laps, from one thread at a time.
using LapSink = std::function<void(std::span<const LaneRecord>)>;

/// Runs a method on every scene, with a new detector for each lap. The first scene of a lap is answered
/// untimed before. The cut to the cone set is part of the method and of its time.
void run(const Method& method, std::span<const AnnotatedScene> scenes, const RunOptions& options,
         const LapSink& sink);

/// The same, all records at once.
[[nodiscard]] std::vector<LaneRecord> run(const Method& method, std::span<const AnnotatedScene> scenes,
                                          const RunOptions& options);

/// Keeps the calling thread on its current processor until destroyed. If the system does not allow this, the
/// thread is not pinned.
class PinnedThread {
  public:
    PinnedThread();
    ~PinnedThread();
    PinnedThread(const PinnedThread&) = delete;
    PinnedThread& operator=(const PinnedThread&) = delete;

  private:
    struct Mask;
    std::unique_ptr<Mask> before_;  ///< absent if the thread is not pinned
};

}  // namespace conelane::experiments
