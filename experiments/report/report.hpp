#pragma once

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/lane_file.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/track.hpp"

#include <stdexcept>

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

/// A lane of a picture. The drivable lane gives the trusted length and the inferred boundary.
struct PicturedLane {
    LaneRecord record;
    DrivableLane drivable;
};

/// A scene as the viewer of the report page draws it.
struct Picture {
    AnnotatedScene scene;
    TrackBoundariesByName
        tracks;  ///< the track of the scene, or nothing; needed to tell false cones from those of the course
    std::vector<PicturedLane> lanes;
    bool with_given = false;  ///< a second panel with the input of a detector
    bool with_truth = true;   ///< the band of the ground truth
    std::string title;        ///< above the lanes; empty: the scene's id
};

/// Writes a picture as .svg or .png, by the ending of its name, through the Python package in the program.
/// The same picture gives the same bytes. `wished_python` and errors: see run_package; also InputError if the
/// file cannot be written.
void write_picture(const Picture& picture, const std::filesystem::path& file,
                   const std::string& wished_python = "");

/// Makes one self-contained HTML page of a directory that `compare` wrote, by the Python package in the
/// program; with `pictures`, also the main figures as PNG in that folder. `wished_python`: an interpreter
/// that has matplotlib; empty: the first found. `viewer_tracks`: tracks whose laps the viewer has, separated
/// by commas; empty: as many laps as fit. Throws PackageRefused if a file of the results is invalid,
/// std::runtime_error if Python or matplotlib is missing.
void write_report(const std::filesystem::path& results, const std::filesystem::path& page,
                  const std::filesystem::path& pictures = {}, const std::string& wished_python = "",
                  const std::string& viewer_tracks = "");

}  // namespace conelane::experiments
