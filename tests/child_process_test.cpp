// Work in a child process: its answer comes back whole, and its death is survived.

#include "solvers/detail/child_process.hpp"

#include <csignal>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace conelane::detail {
namespace {

TEST(ChildProcess, AnswersWithItsNumbers) {
    const std::vector<double> some{1.0, -2.5, 1e300};
    EXPECT_EQ(run_in_child([&] { return some; }), some);
    EXPECT_EQ(run_in_child([] { return std::vector<double>{}; }), std::vector<double>{});
    // More than a pipe holds.
    const std::vector<double> many(100000, 3.0);
    EXPECT_EQ(run_in_child([&] { return many; }), many);
}

TEST(ChildProcess, ThatDiesAnswersNothing) {
    EXPECT_EQ(run_in_child([]() -> std::vector<double> {
                  std::raise(SIGKILL);
                  return {1.0};
              }),
              std::nullopt);
    EXPECT_EQ(run_in_child([]() -> std::vector<double> { throw std::runtime_error("no answer"); }),
              std::nullopt);
}

}  // namespace
}  // namespace conelane::detail
