#pragma once

#include "evaluation/input_error.hpp"
#include "tests/support/testing.hpp"

#include <iterator>

#include <unistd.h>

namespace conelane {

/// A folder of its own for each test, so that tests may run at the same time.
class FileTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        std::string name = std::string(test->test_suite_name()) + "." + test->name();
        for (char& c : name) c = c == '/' ? '_' : c;
        folder_ = std::filesystem::path(testing::TempDir()) /
                  ("conelane_" + std::to_string(::getpid()) + "_" + name);
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_ / name; }
    std::filesystem::path file_with(const std::string& text, const std::string& name = "file") const {
        std::ofstream(path(name), std::ios::binary) << text;
        return path(name);
    }
    [[nodiscard]] static std::string text_of(const std::filesystem::path& file) {
        std::ifstream stream(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    }
    [[nodiscard]] std::size_t files_in_folder() const {
        return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
    }
    /// The message of `read` about a file, without the folder.
    [[nodiscard]] std::string error_of(const std::function<void()>& read) const {
        try {
            read();
        } catch (const InputError& error) {
            const std::string text = error.what();
            const std::string prefix = folder_.string() + "/";
            return text.starts_with(prefix) ? text.substr(prefix.size()) : text;
        }
        return "no error";
    }

  private:
    std::filesystem::path folder_;
};

}  // namespace conelane
