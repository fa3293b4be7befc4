#include "evaluation/progress/progress.hpp"

#include <cstdio>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace conelane {
namespace {

constexpr std::size_t kBarWidth = 30;
constexpr std::chrono::milliseconds kRedraw{200};

}  // namespace

Progress::Progress(std::string what, std::size_t total)
    : what_(std::move(what)),
      total_(total),
      shown_(total > 0 && isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      next_draw_(start_ + kRedraw) {}

Progress::~Progress() {
    if (shown_) fmt::print(stderr, "\r\033[K");
}

void Progress::advance() {
    const std::size_t done = ++done_;
    if (!shown_) return;
    const Clock::time_point now = Clock::now();
    const std::unique_lock lock(drawing_, std::try_to_lock);
    if (!lock.owns_lock() || now < next_draw_) return;
    next_draw_ = now + kRedraw;
    draw(done, now);
}

void Progress::draw(std::size_t done, Clock::time_point now) {
    const double seconds = std::chrono::duration<double>(now - start_).count();
    const double rate = static_cast<double>(done) / seconds;
    const std::size_t filled = kBarWidth * done / total_;
    fmt::print(stderr, "\r\033[K{} [{:#<{}}{: <{}}] {}/{}  {:.0f}/s  {:.0f} s left", what_, "", filled, "",
               kBarWidth - filled, done, total_, rate, static_cast<double>(total_ - done) / rate);
    std::fflush(stderr);
}

}  // namespace conelane
