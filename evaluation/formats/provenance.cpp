#include "evaluation/formats/provenance.hpp"

#include <fstream>
#include <thread>

#include <fmt/format.h>
#include <sys/utsname.h>

namespace conelane {

extern const char* const kBuiltCommit;  // in a source file that the build generates

namespace {

std::string processor() {
    std::ifstream cpuinfo("/proc/cpuinfo");
    for (std::string line; std::getline(cpuinfo, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown processor";
}

}  // namespace

Provenance provenance() {
    utsname system{};
    uname(&system);
#ifdef NDEBUG
    const char* const assertions = "without assertions";
#else
    const char* const assertions = "with assertions";
#endif
#ifdef __clang__
    const char* const compiler = "Clang " __clang_version__;
#else
    const char* const compiler = "GCC " __VERSION__;
#endif
    return {kBuiltCommit, fmt::format("{}, {}", compiler, assertions),
            fmt::format("{}, {} processors, {} {} {}", processor(), std::thread::hardware_concurrency(),
                        system.sysname, system.release, system.machine)};
}

}  // namespace conelane
