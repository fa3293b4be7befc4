#pragma once

#include "evaluation/formats/interruption.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace conelane::experiments {

/// A temporary folder, removed with the object or when the program ends.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder() { remove(); }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    void remove() const;

    std::filesystem::path path_;
    std::optional<ClearOnInterruption> clearing_;
};

/// No Python with the modules that the package needs was found.
class NoPython : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The Python package in the program refused its input and gave the reason on stderr.
class PackageRefused : public std::runtime_error {
  public:
    PackageRefused() : std::runtime_error("what was to be drawn was refused") {}
};

/// Runs a module of the Python package `report` (this folder, embedded in the program) with arguments.
/// `wished_python`: an interpreter; empty: the first found. `draws`: it needs matplotlib. Throws
/// PackageRefused if the module ends with exit code 2, NoPython if Python or matplotlib is missing,
/// std::runtime_error for other failures.
void run_package(const std::string& module, const std::vector<std::string>& arguments,
                 const std::string& wished_python, bool draws = true);

/// The Python package `report` of this folder as a zip archive that Python can import.
[[nodiscard]] std::span<const unsigned char> report_archive();

struct MadeFile {
    std::filesystem::path file;
    std::filesystem::path place;
};
/// Puts all files in place, or none. Throws InputError naming the place that fails.
void put_in_place(const std::vector<MadeFile>& files);

}  // namespace conelane::experiments
