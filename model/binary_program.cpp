#include "model/binary_program.hpp"

namespace conelane {

std::string to_string(const Label& label) {
    std::string text(label.family);
    for (const std::int32_t index : {label.index.first, label.index.second, label.index.third}) {
        if (index >= 0) text.append("_").append(std::to_string(index));
    }
    return text;
}

int BinaryProgram::add_column(const Label& label, double objective, bool integer, double lower,
                              double upper) {
    columns.push_back({label, objective, lower, upper, integer});
    return static_cast<int>(columns.size()) - 1;
}

void BinaryProgram::truncate_rows(std::size_t first) {
    rows.resize(first);
    row_starts.resize(first + 1);
    entry_columns.resize(static_cast<std::size_t>(row_starts.back()));
    entry_values.resize(entry_columns.size());
}

RowWriter::RowWriter(BinaryProgram& program, const Deadline* deadline)
    : program_(program), deadline_(deadline), position_(program.columns.size(), -1) {}

bool RowWriter::stop() {
    constexpr int kRowsPerClock = 8;
    if (deadline_ == nullptr || stopped_by_ || --until_clock_ > 0) return stopped_by_.has_value();
    until_clock_ = kRowsPerClock;
    if (program_.columns.size() + program_.entry_columns.size() > kMaxProgramEntries) {
        stopped_by_ = StopReason::memory;
    } else if (deadline_->passed()) {
        stopped_by_ = StopReason::time;
    }
    return stopped_by_.has_value();
}

void RowWriter::begin(const Label& label, double lower, double upper) {
    program_.rows.push_back({label, lower, upper});
}

void RowWriter::add(int column, double coefficient) {
    int& position = position_[static_cast<std::size_t>(column)];
    if (position < 0) {
        position = static_cast<int>(program_.entry_columns.size());
        program_.entry_columns.push_back(column);
        program_.entry_values.push_back(coefficient);
    } else {
        program_.entry_values[static_cast<std::size_t>(position)] += coefficient;
    }
}

void RowWriter::end() {
    for (auto entry = static_cast<std::size_t>(program_.row_starts.back());
         entry < program_.entry_columns.size(); ++entry) {
        position_[static_cast<std::size_t>(program_.entry_columns[entry])] = -1;
    }
    program_.row_starts.push_back(static_cast<int>(program_.entry_columns.size()));
}

}  // namespace conelane
