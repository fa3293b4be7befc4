#pragma once

#include "evaluation/formats/atomic_file.hpp"

#include <cstddef>
#include <string>
#include <string_view>

#include <sys/types.h>

namespace conelane {

/// A program that answers line by line over standard input and output, started by `/bin/sh -c` in its own
/// process group. For any behaviour of the program, no call here waits longer than its limit, and no signal
/// that it causes reaches this program. Its group is killed when the object is destroyed, and when a signal
/// ends this program.
class ChildProcess {
  public:
    /// Throws std::system_error if no process can be started. A missing program is noticed later: the shell
    /// reports it and ends.
    explicit ChildProcess(const std::string& command);
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    enum class Outcome {
        line,
        late,           ///< no line within the limit
        too_long,       ///< more than kMaxLine without a newline
        closed_input,   ///< it does not read its input
        closed_output,  ///< it has ended, or has closed its output
    };
    struct Reply {
        Outcome outcome;
        std::string line;  ///< without newline
    };
    static constexpr std::size_t kMaxLine = std::size_t{4} << 20U;

    /// Sends whole lines that need no answer, as far as the program reads; the rest is sent with the next
    /// question.
    void tell(std::string_view text);
    /// Sends whole lines and waits for the next line of the program. Its standard error is read meanwhile.
    [[nodiscard]] Reply ask(std::string_view text, double limit_ms);

    /// Closes its input, waits for its end up to this limit, kills the rest of its group, and returns how it
    /// ended: "exit code 3", "signal 11"; empty if it had to be killed.
    std::string end(double patience_ms);
    /// Ends it after a failure, waiting only if the outcome says that it is ending. Adds to the fault how it
    /// ended and what it said.
    void end_failed(Outcome outcome, std::string& fault);

    /// The largest resident memory of any of its processes, by the operating system [bytes]; known after
    /// `end`, 0 before.
    [[nodiscard]] std::size_t peak_bytes() const { return peak_bytes_; }

    /// The last two lines of its standard error that are not blank (a shell may add one), shortened for a
    /// message. Complete after `end`.
    [[nodiscard]] std::string last_words() const;

  private:
    void write_pending();
    void read_output();
    void read_errors();
    [[nodiscard]] bool has_exited() const;
    std::string reap();

    pid_t pid_ = -1;  ///< of the shell and of the group; -1 once it has ended
    int input_ = -1;
    int output_ = -1;
    int errors_ = -1;
    std::string pending_;   ///< not yet written
    std::string received_;  ///< not yet a whole line
    std::string error_tail_;
    std::size_t peak_bytes_ = 0;
    std::optional<ClearOnInterruption> clearing_;
};

/// The reason why there was no line, in words; empty if there was one. `limit_ms`: the limit of waiting.
[[nodiscard]] std::string fault_of(ChildProcess::Outcome outcome, double limit_ms);

}  // namespace conelane
