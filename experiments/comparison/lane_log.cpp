#include "experiments/comparison/lane_log.hpp"

#include "evaluation/input_error.hpp"

#include <cerrno>
#include <cstdint>
#include <fstream>
#include <string>
#include <system_error>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

/// Length of the first `count` whole lines, and how many whole lines there are.
struct Lines {
    std::uintmax_t length = 0;
    std::size_t count = 0;
};
Lines whole_lines(const fs::path& file, std::size_t at_most) {
    std::ifstream stream(file, std::ios::binary);
    Lines lines;
    std::string line;
    while (lines.count < at_most && std::getline(stream, line) && !stream.eof()) {
        lines.length += line.size() + 1;
        ++lines.count;
    }
    return lines;
}

}  // namespace

LaneLog::LaneLog(const fs::path& file) : file_(file), part_(file.string() + ".part") {
    keep(SIZE_MAX);
}

void LaneLog::keep(std::size_t count) {
    if (stream_.is_open()) stream_.close();
    std::error_code failure;
    if (fs::exists(part_)) {
        const Lines lines = whole_lines(part_, count);
        fs::resize_file(part_, lines.length, failure);
        stored_ = lines.count;
    }
    stream_.open(part_, std::ios::binary | std::ios::app);
    if (!stream_) failure = std::error_code(errno, std::generic_category());
    if (failure) throw InputError(part_, 0, "", "cannot be written: " + failure.message());
}

void LaneLog::append(std::span<const LaneRecord> records) {
    for (const LaneRecord& record : records) stream_ << lane_line(record) << '\n';
    stream_.flush();
    stream_.require_written(part_);
}

void LaneLog::finish() {
    stream_.close();
    stream_.require_written(part_);
    std::error_code failure;
    fs::rename(part_, file_, failure);
    if (failure) throw InputError(file_, 0, "", "cannot be written: " + failure.message());
}

}  // namespace conelane::experiments
