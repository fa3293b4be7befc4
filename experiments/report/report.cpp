#include "experiments/report/report.hpp"

#include "evaluation/formats/scene_file.hpp"
#include "evaluation/scoring/published_figures.hpp"
#include "evaluation/world/scene_generation.hpp"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <system_error>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace conelane {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PublishedClcRow, false_positive_rate, ground_truth, near_ground_truth,
                                   too_short, diverging_from_20, diverging_below_20, success, mean_iou,
                                   complete)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PublishedRldRow, false_positive_rate, inaccurate)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Condition, name, noise_sigma_m, pose_noise_lateral_m, pose_noise_yaw_rad,
                                   miss_rate, persistent)

}  // namespace conelane

namespace conelane::experiments {
namespace {

/// Runs a program found on PATH. Returns its exit code, or -1 if there is no such program or it was killed.
/// It is killed if this program ends.
int run(std::vector<std::string> command, bool quiet) {
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    if (quiet) posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    // Its own process group: with Ctrl-C, this program ends it, and it prints no traceback.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    auto held = hold_interruption();
    pid_t child = 0;
    const int failure =
        posix_spawnp(&child, arguments.front(), &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (failure != 0) return -1;
    const ClearOnInterruption ending([child] {
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
    });
    held.unlock();
    siginfo_t ended{};
    while (::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
    }
    held.lock();  // only now may the system give its number to another program
    int status = 0;
    if (::waitpid(child, &status, 0) != child) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// The first Python that has the modules of the report. The second place has Debian's own packages, in case
/// another Python is first on PATH.
std::string find_python(const std::string& wished, bool draws) {
    const std::vector<std::string> candidates =
        wished.empty() ? std::vector<std::string>{"python3", "/usr/bin/python3"} : std::vector{wished};
    for (const std::string& python : candidates) {
        const std::string probe =
            "import sys; from importlib.util import find_spec; "
            "sys.exit(not (sys.version_info >= (3, 10)" +
            std::string(draws ? " and find_spec('numpy') and find_spec('matplotlib')))" : "))");
        if (run({python, "-c", probe}, true) == 0) return python;
    }
    const std::string name = wished.empty() ? "python3" : wished;
    if (!draws) throw NoPython("the page takes Python 3.10 or newer, which " + name + " is not");
    throw NoPython("the report takes Python 3.10 or newer with matplotlib, which " + name +
                   " has not (Debian: apt-get install python3-matplotlib)");
}

void write_archive(const std::filesystem::path& file) {
    const auto bytes = report_archive();
    OutputStream stream;
    stream.open(file, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    stream.require_written(file);
}

using nlohmann::ordered_json;

/// A condition with replaced parts is called NAME+PART; its noise is assumed to be that of NAME.
double noise_of(const std::string& condition) {
    for (const Condition& known : named_conditions()) {
        if (condition == known.name || condition.starts_with(known.name + "+")) return known.noise_sigma_m;
    }
    return 0.0;
}

/// The point of the boundary on one side of a point of the centre line.
ordered_json beside(const DrivablePoint& point, bool on_left) {
    const Point normal(-std::sin(point.heading_rad), std::cos(point.heading_rad));
    const Point at = point.position + (on_left ? point.width_left_m : -point.width_right_m) * normal;
    return ordered_json::array({at.x(), at.y()});
}

/// The drawn parts of a lane besides its cones.
ordered_json overlay(const DrivableLane& lane) {
    ordered_json json = ordered_json::object();
    if (lane.left_inferred || lane.right_inferred) {
        ordered_json& points = json["inferred"] = ordered_json::array();
        for (const DrivablePoint& point : lane.points) points.push_back(beside(point, lane.left_inferred));
    }
    if (lane.trusted_m && !lane.points.empty()) {
        const auto past = std::ranges::find_if(
            lane.points, [&](const DrivablePoint& point) { return point.s_m > *lane.trusted_m; });
        const DrivablePoint& last = past == lane.points.begin() ? *past : *(past - 1);
        json["trusted_end"] = ordered_json::array({beside(last, true), beside(last, false)});
    }
    return json;
}

/// Data for the report: the figures of the papers, the named conditions, and the gap from which a boundary is
/// drawn as bridged.
std::string published() {
    const std::span<const Condition> known = named_conditions();
    const std::vector<Condition> conditions(known.begin(), known.end());
    return nlohmann::json{{"longest_gap_m", DrivableOptions{}.max_gap_m},
                          {"usual_width_m", DrivableOptions{}.default_width_m},
                          {"conditions", conditions},
                          {"clc", kPublishedClc},
                          {"clc_median_below_ms", kPublishedClcMedianBelow_ms},
                          {"clc_max_ms", kPublishedClcMax_ms},
                          {"rld", kPublishedRld},
                          {"rld_cone_set", kPublishedRldConeSet},
                          {"rld_solved", kPublishedRldSolved},
                          {"rld_mean_ms", kPublishedRldMean_ms},
                          {"rld_p95_ms", kPublishedRldP95_ms},
                          {"rld_standard_deviation_ms", kPublishedRldStandardDeviation_ms}}
        .dump();
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
    std::string name = std::filesystem::temp_directory_path() / "conelane-XXXXXX";
    const auto held = hold_interruption();
    if (mkdtemp(name.data()) == nullptr) {
        throw InputError(name, 0, "", "cannot be made: " + std::generic_category().message(errno));
    }
    path_ = name;
    clearing_.emplace([this] { remove(); });
}

void TemporaryFolder::remove() const {
    const auto held = hold_interruption();
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

void run_package(const std::string& module, const std::vector<std::string>& arguments,
                 const std::string& wished_python, bool draws) {
    const std::string python = find_python(wished_python, draws);
    const TemporaryFolder folder;
    const std::filesystem::path archive = folder.path() / "report.zip";
    write_archive(archive);
    const std::string start =
        "import sys, runpy; sys.path.insert(0, sys.argv.pop(1)); "
        "runpy.run_module(sys.argv.pop(1), run_name='__main__', alter_sys=True)";
    std::vector<std::string> command{python, "-c", start, archive, module};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const int code = run(command, false);
    if (code == 2) throw PackageRefused();
    if (code != 0) throw std::runtime_error("drawing failed, see above");
}

void put_in_place(const std::vector<MadeFile>& files) {
    std::vector<std::unique_ptr<AtomicFile>> outputs;
    std::vector<AtomicFile*> all;
    for (const auto& [file, place] : files) {
        std::ifstream from(file, std::ios::binary);
        all.push_back(outputs.emplace_back(std::make_unique<AtomicFile>(place)).get());
        all.back()->stream() << from.rdbuf();
        all.back()->finish();
    }
    commit_together(all);
}

void write_picture(const Picture& picture, const std::filesystem::path& file,
                   const std::string& wished_python) {
    require_writable(file);
    const TemporaryFolder folder;
    const std::filesystem::path scene = folder.path() / "one.scenes.jsonl";
    const std::filesystem::path lanes = folder.path() / "one.lanes.jsonl";
    const std::filesystem::path how = folder.path() / "how.json";
    const std::filesystem::path made = folder.path() / ("made" + file.extension().string());
    write_scenes(scene, {&picture.scene, 1});
    write_track_boundaries(track_boundaries_path(scene), picture.tracks);
    std::vector<LaneRecord> records;
    ordered_json overlays = ordered_json::array();
    for (const PicturedLane& lane : picture.lanes) {
        records.push_back(lane.record);
        overlays.push_back(overlay(lane.drivable));
    }
    write_lanes(lanes, records);
    AtomicFile description(how);
    description.stream() << ordered_json{
        {"noise_m", noise_of(picture.scene.condition)},
        {"longest_gap_m", DrivableOptions{}.max_gap_m},
        {"with_given", picture.with_given},
        {"with_truth", picture.with_truth},
        {"title", picture.title},
        {"overlays", overlays}}.dump();
    description.commit();
    run_package("report.plot", {scene, track_boundaries_path(scene), lanes, how, made}, wished_python);
    put_in_place({{made, file}});
}

void write_report(const std::filesystem::path& results, const std::filesystem::path& page,
                  const std::filesystem::path& pictures, const std::string& wished_python,
                  const std::string& viewer_tracks) {
    require_writable(page);
    const TemporaryFolder folder;
    const std::filesystem::path made_page = folder.path() / "page.html";
    const std::filesystem::path made_pictures = pictures.empty() ? "" : folder.path() / "pictures";
    run_package("report", {results.string(), made_page, published(), made_pictures, viewer_tracks},
                wished_python);
    std::vector<MadeFile> files;
    if (!pictures.empty()) {
        std::error_code failure;
        std::filesystem::create_directories(pictures, failure);
        if (failure) throw InputError(pictures, 0, "", "cannot be made: " + failure.message());
        for (const auto& picture : std::filesystem::directory_iterator(made_pictures)) {
            files.push_back({picture.path(), pictures / picture.path().filename()});
        }
    }
    files.push_back({made_page, page});
    put_in_place(files);
}

}  // namespace conelane::experiments
