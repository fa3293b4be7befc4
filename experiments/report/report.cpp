#include "experiments/report/report.hpp"

#include "experiments/files/atomic_file.hpp"
#include "experiments/files/input_error.hpp"
#include "experiments/files/interruption.hpp"
#include "experiments/report/archive.hpp"
#include "experiments/scenes/condition.hpp"
#include "experiments/scoring/published_figures.hpp"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace conelane::experiments {
namespace {

/// A folder of its own below the system's temporary one, gone with the object or with the program.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string name = std::filesystem::temp_directory_path() / "conelane-XXXXXX";
        const auto held = hold_interruption();
        if (mkdtemp(name.data()) == nullptr) throw InputError(name, 0, "", "cannot be made");
        path_ = name;
        clearing_.emplace([this] { remove(); });
    }
    ~TemporaryFolder() { remove(); }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    void remove() const {
        const auto held = hold_interruption();
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }

    std::filesystem::path path_;
    std::optional<ClearOnInterruption> clearing_;
};

/// Runs a program found on PATH; its exit code, or -1 where there is no such program or it was killed. It
/// ends with this one.
int run(std::vector<std::string> command, bool quiet) {
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    if (quiet) posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    // A group of its own: Ctrl-C ends it by this program, without a traceback.
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
    held.lock();  // only now may its number go to another program
    int status = 0;
    if (::waitpid(child, &status, 0) != child) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// The first Python that has what the report draws with. The second place is where Debian's own packages go,
/// should another Python come first on PATH.
std::string find_python(const std::string& wished) {
    const std::vector<std::string> candidates =
        wished.empty() ? std::vector<std::string>{"python3", "/usr/bin/python3"} : std::vector{wished};
    for (const std::string& python : candidates) {
        const std::string probe =
            "import sys; from importlib.util import find_spec; "
            "sys.exit(not (sys.version_info >= (3, 10) and find_spec('numpy') and find_spec('matplotlib')))";
        if (run({python, "-c", probe}, true) == 0) return python;
    }
    throw std::runtime_error("the report takes Python 3.10 or newer with matplotlib, which " +
                             (wished.empty() ? "python3" : wished) +
                             " has not (Debian: apt-get install python3-matplotlib)");
}

/// What the papers print, for the report to show beside, and what the named conditions are.
std::string published() {
    nlohmann::ordered_json clc = nlohmann::ordered_json::array();
    for (const PublishedClcRow& row : kPublishedClc) {
        clc.push_back({{"rate", row.false_positive_rate},
                       {"ground_truth", row.ground_truth},
                       {"near_ground_truth", row.near_ground_truth},
                       {"too_short", row.too_short},
                       {"diverging_from_20", row.diverging_from_20},
                       {"diverging_below_20", row.diverging_below_20},
                       {"success", row.success},
                       {"mean_iou", row.mean_iou},
                       {"complete", row.complete}});
    }
    nlohmann::ordered_json rld = nlohmann::ordered_json::array();
    for (const PublishedRldRow& row : kPublishedRld) {
        rld.push_back({{"rate", row.false_positive_rate},
                       {"ratio", row.printed_ratio},
                       {"inaccurate", row.inaccurate},
                       {"upper_bound", row.upper_bound}});
    }
    nlohmann::ordered_json conditions = nlohmann::ordered_json::array();
    for (const Condition& condition : named_conditions()) {
        conditions.push_back({{"name", condition.name},
                              {"noise_m", condition.noise_sigma_m},
                              {"pose_lateral_m", condition.pose_noise_lateral_m},
                              {"pose_yaw_rad", condition.pose_noise_yaw_rad},
                              {"miss_rate", condition.miss_rate},
                              {"persistent", condition.persistent}});
    }
    return nlohmann::ordered_json{{"conditions", conditions},
                                  {"clc", clc},
                                  {"clc_median_below_ms", kPublishedClcMedianBelow_ms},
                                  {"clc_max_ms", kPublishedClcMax_ms},
                                  {"rld", rld},
                                  {"rld_cone_set", kPublishedRldConeSet},
                                  {"rld_solved", kPublishedRldSolved},
                                  {"rld_mean_ms", kPublishedRldMean_ms},
                                  {"rld_p95_ms", kPublishedRldP95_ms},
                                  {"rld_standard_deviation_ms", kPublishedRldStandardDeviation_ms}}
        .dump();
}

void write_archive(const std::filesystem::path& file) {
    const auto bytes = report_archive();
    std::ofstream stream(file, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    if (!stream) throw InputError(file, 0, "", "cannot be written");
}

/// Puts a file in its place whole or not at all.
void put(const std::filesystem::path& file, const std::filesystem::path& place) {
    std::ifstream from(file, std::ios::binary);
    AtomicFile to(place);
    to.stream() << from.rdbuf();
    to.commit();
}

}  // namespace

void write_report(const std::filesystem::path& results, const std::filesystem::path& page,
                  const std::filesystem::path& pictures, const std::string& wished_python,
                  const std::string& viewer_tracks) {
    require_writable(page);
    const std::string python = find_python(wished_python);
    const TemporaryFolder folder;
    const std::filesystem::path archive = folder.path() / "report.zip";
    write_archive(archive);
    const std::string start =
        "import sys, runpy; sys.path.insert(0, sys.argv.pop(1)); "
        "runpy.run_module('report', run_name='__main__', alter_sys=True)";
    const std::filesystem::path made_page = folder.path() / "page.html";
    const std::filesystem::path made_pictures = pictures.empty() ? "" : folder.path() / "pictures";
    const int code = run({python, "-c", start, archive, results.string(), made_page, published(),
                          made_pictures, viewer_tracks},
                         false);
    if (code == 2) throw ReportRefused();
    if (code != 0) throw std::runtime_error("the report failed, see above");
    if (!pictures.empty()) {
        std::error_code failure;
        std::filesystem::create_directories(pictures, failure);
        if (failure) throw InputError(pictures, 0, "", "cannot be made: " + failure.message());
        for (const auto& picture : std::filesystem::directory_iterator(made_pictures)) {
            put(picture.path(), pictures / picture.path().filename());
        }
    }
    put(made_page, page);
}

}  // namespace conelane::experiments
