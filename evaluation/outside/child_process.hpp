#pragma once

#include "evaluation/files/interruption.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <sys/types.h>

namespace conelane {

/// A program that is spoken to line by line over its standard input and output, started by `/bin/sh -c` in a
/// process group of its own. Whatever it does, no call here waits longer than it was told, and no signal that
/// it causes reaches this program. Its group is killed with the object, and where a signal ends this program.
class ChildProcess {
  public:
    /// Throws std::system_error where no process can be started. That there is no such program shows later:
    /// the shell says it and ends.
    explicit ChildProcess(const std::string& command);
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    enum class Outcome {
        line,
        late,           ///< no line within the limit
        too_long,       ///< more than kMaxLine without a newline
        closed_input,   ///< it does not read on
        closed_output,  ///< it has ended, or will not write on
    };
    struct Reply {
        Outcome outcome;
        std::string line;  ///< without newline
    };
    static constexpr std::size_t kMaxLine = std::size_t{4} << 20U;

    /// Sends a text of whole lines that asks for no answer, as far as the program reads; the rest goes out
    /// with the next question.
    void tell(std::string_view text);
    /// Sends a text of whole lines and waits for the next line of the program. What it writes on its standard
    /// error is read meanwhile.
    [[nodiscard]] Reply ask(std::string_view text, double limit_ms);

    /// Closes its input, waits for its end no longer than this, kills what is left of its group, and says how
    /// it ended: "exit code 3", "signal 11"; empty where it had to be killed.
    std::string end(double patience_ms);

    /// The largest resident memory of any process that it consisted of, by the operating system [bytes];
    /// known after `end`, 0 before.
    [[nodiscard]] std::size_t peak_bytes() const { return peak_bytes_; }

    /// The last two lines of its standard error that are not blank, since a shell may add one of its own, cut
    /// to a length that fits a message. Complete after `end`.
    [[nodiscard]] std::string last_words() const;

  private:
    void write_pending();
    void read_output();
    void read_errors();
    [[nodiscard]] bool has_exited() const;
    std::string reap();

    pid_t pid_ = -1;  ///< of the shell and of the group; -1 once it was reaped
    int input_ = -1;
    int output_ = -1;
    int errors_ = -1;
    std::string pending_;   ///< not yet written
    std::string received_;  ///< not yet a whole line
    std::string error_tail_;
    std::size_t peak_bytes_ = 0;
    std::optional<ClearOnInterruption> clearing_;
};

/// What went wrong where there was no line, in words; empty where there was one. `limit_ms`: what was waited
/// for.
[[nodiscard]] std::string fault_of(ChildProcess::Outcome outcome, double limit_ms);

}  // namespace conelane
