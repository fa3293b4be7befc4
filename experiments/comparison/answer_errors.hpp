#pragma once

#include "evaluation/formats/lane_file.hpp"

namespace conelane::experiments {

/// Answers of status error, by the detector or solver that gave them.
class AnswerErrors {
  public:
    void add_answer(std::string_view detector) { ++count_of(detector).answers; }
    void add_error(std::string_view detector, const std::string& scene, const std::string& message);

    /// One line for each detector with errors: their number, and the first message.
    [[nodiscard]] std::vector<std::string> lines() const;
    /// Whether all answers of some detector are errors.
    [[nodiscard]] bool any_answered_nothing() const;

  private:
    struct Count {
        std::string detector;
        std::size_t answers = 0;  ///< errors among them
        std::size_t errors = 0;
        std::string first;
    };
    Count& count_of(std::string_view detector);
    std::vector<Count> counts_;  ///< in the order in which the detectors are met
};

/// Counts a lane, or an error if the answer has status error.
void add_answer_of(AnswerErrors& errors, const LaneRecord& record);

}  // namespace conelane::experiments
