#pragma once

#include "experiments/files/interruption.hpp"

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace conelane::experiments {

/// A folder of its own below the system's temporary one, gone with the object or with the program.
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

/// There is no Python with what the package takes.
class NoPython : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// The Python package that the program carries refused its input and has said why on stderr.
class PackageRefused : public std::runtime_error {
  public:
    PackageRefused() : std::runtime_error("what was to be drawn was refused") {}
};

/// Runs a module of the Python package `report` (this folder, carried by the program) with arguments.
/// `wished_python`: an interpreter that has matplotlib; empty: the first found. Throws PackageRefused where
/// the module ends with exit code 2, NoPython where Python or matplotlib is missing, std::runtime_error where
/// it fails otherwise.
void run_package(const std::string& module, const std::vector<std::string>& arguments,
                 const std::string& wished_python);

struct MadeFile {
    std::filesystem::path file;
    std::filesystem::path place;
};
/// Puts all files in their places whole or none of them. Throws InputError naming the place that fails.
void put_in_place(const std::vector<MadeFile>& files);

}  // namespace conelane::experiments
