#include "experiments/report/package.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/input_error.hpp"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <system_error>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

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

}  // namespace conelane::experiments
