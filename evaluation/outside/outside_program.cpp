#include "evaluation/outside/outside_program.hpp"

#include "evaluation/formats/scene_file.hpp"
#include "evaluation/outside/point_snapping.hpp"
#include "model/deadline.hpp"

#include <system_error>

#include <fmt/format.h>

namespace conelane {
namespace {

constexpr const char* kReset = "{\"reset\": true}\n";

}  // namespace

OutsideProgram::OutsideProgram(std::string name, std::string command, const OutsideLimits& limits)
    : name_(std::move(name)), command_(std::move(command)), limits_(limits) {}

OutsideProgram::~OutsideProgram() {
    if (child_) child_->end(limits_.end_ms);
}

LaneRecord OutsideProgram::answer(const Scene& scene) {
    if (is_left_alone_)
        return error(scene, limits_.answer_ms, "not asked after failures in a row, the last: " + last_fault_);
    const Stopwatch starting;
    if (!child_) {
        if (const std::string fault = start(scene); !fault.empty()) {
            const double lost_ms = starting.elapsed_ms();
            count_failure(lost_ms);
            last_fault_ = fault;
            return error(scene, std::min(lost_ms, limits_.answer_ms), fault);
        }
    }
    const Stopwatch watch;
    Attempt attempt = ask(scene, limits_.answer_ms);
    const double latency_ms = watch.elapsed_ms();
    if (!attempt.record) {
        count_failure(starting.elapsed_ms());
        last_fault_ = attempt.fault;
        return error(scene, latency_ms, attempt.fault);
    }
    failures_ = 0;
    lost_ms_ = 0.0;
    next_wait_ = 1;
    if (const std::string tangle = tangle_of(*attempt.record, scene); !tangle.empty())
        return error(scene, latency_ms, tangle);
    attempt.record->latency_ms = latency_ms;
    return *std::move(attempt.record);
}

void OutsideProgram::reset() {
    if (is_left_alone_ && has_answered_ && --laps_to_wait_ <= 0) is_left_alone_ = false;
    if (child_) child_->tell(kReset);
}

/// Starts the program and lets it answer once. Returns the failure in words, or nothing.
std::string OutsideProgram::start(const Scene& scene) {
    try {
        child_ = std::make_unique<ChildProcess>(command_);
    } catch (const std::system_error& failure) {
        return failure.what();
    }
    child_->tell(kReset);
    Attempt first = ask(scene, limits_.start_ms);
    if (child_) {
        child_->tell(kReset);
        has_answered_ = true;
        return "";
    }
    return "after its start: " + first.fault;
}

/// A program that failed is ended. So is one that gave an invalid answer: its next line may be a late answer
/// to an earlier scene.
OutsideProgram::Attempt OutsideProgram::ask(const Scene& scene, double limit_ms) {
    Scene opaque = scene;
    opaque.id = std::to_string(++asked_);
    const ChildProcess::Reply reply = child_->ask(scene_line(opaque) + '\n', limit_ms);
    Attempt attempt;
    attempt.fault = fault_of(reply.outcome, limit_ms);
    if (reply.outcome == ChildProcess::Outcome::line) {
        try {
            LaneRecord record = read_foreign_lane(reply.line);
            attempt.fault =
                record.scene == opaque.id
                    ? fault_of(record, scene)
                    : fmt::format(R"(answers scene "{:.20}" instead of "{}")", record.scene, opaque.id);
            if (attempt.fault.empty()) {
                snap_to_cones(record, scene);
                record.scene = scene.id;
                record.detector = name_;
                attempt.record = std::move(record);
                return attempt;
            }
        } catch (const InputError& wrong) {
            attempt.fault = std::string("its answer is wrong: ") + wrong.what();
        }
    }
    child_->end_failed(reply.outcome, attempt.fault);
    child_.reset();
    return attempt;
}

void OutsideProgram::count_failure(double lost_ms) {
    lost_ms_ += lost_ms;
    const bool tried_again = next_wait_ > 1;
    if (++failures_ < limits_.failures && lost_ms_ < limits_.lost_ms && !tried_again) return;
    is_left_alone_ = true;
    laps_to_wait_ = next_wait_;
    next_wait_ *= 2;
    failures_ = 0;
    lost_ms_ = 0.0;
}

LaneRecord OutsideProgram::error(const Scene& scene, double latency_ms, const std::string& message) const {
    LaneRecord record{
        .scene = scene.id, .detector = name_, .answer = {}, .latency_ms = latency_ms, .nearest = {}};
    record.answer.status = LaneStatus::error;
    record.answer.message = message;
    return record;
}

std::unique_ptr<OutsideProgram> OutsideProgramPool::take() {
    std::unique_ptr<OutsideProgram> program;
    {
        const std::scoped_lock lock(mutex_);
        if (!idle_.empty()) {
            program = std::move(idle_.back());
            idle_.pop_back();
        }
    }
    if (!program) program = std::make_unique<OutsideProgram>(name_, command_);
    program->reset();
    return program;
}

void OutsideProgramPool::give_back(std::unique_ptr<OutsideProgram> program) {
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(program));
}

}  // namespace conelane
