#include "experiments/comparison/answer_errors.hpp"

#include <fmt/format.h>

namespace conelane::experiments {

AnswerErrors::Count& AnswerErrors::count_of(std::string_view detector) {
    const auto known = std::ranges::find(counts_, detector, &Count::detector);
    if (known != counts_.end()) return *known;
    Count& count = counts_.emplace_back();
    count.detector = detector;
    return count;
}

void AnswerErrors::add_error(std::string_view detector, const std::string& scene,
                             const std::string& message) {
    Count& count = count_of(detector);
    ++count.answers;
    if (++count.errors == 1) count.first = scene + ": " + message;
}

std::vector<std::string> AnswerErrors::lines() const {
    std::vector<std::string> lines;
    for (const Count& count : counts_) {
        if (count.errors == 0) continue;
        std::string line = fmt::format("{}: {} of {} answers are errors, the first to {}", count.detector,
                                       count.errors, count.answers, count.first);
        // A message may quote a program from outside.
        std::ranges::replace_if(
            line, [](char letter) { return letter == '\n' || letter == '\r'; }, ' ');
        lines.push_back(std::move(line));
    }
    return lines;
}

bool AnswerErrors::any_answered_nothing() const {
    return std::ranges::any_of(
        counts_, [](const Count& count) { return count.answers > 0 && count.errors == count.answers; });
}

void add_answer_of(AnswerErrors& errors, const LaneRecord& record) {
    const std::string detector =
        record.nearest ? fmt::format("{} n={}", record.detector, *record.nearest) : record.detector;
    if (record.answer.status == LaneStatus::error) {
        errors.add_error(detector, record.scene, record.answer.message);
    } else {
        errors.add_answer(detector);
    }
}

}  // namespace conelane::experiments
