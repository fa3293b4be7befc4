#include "experiments/comparison/echo_floor.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"
#include "experiments/comparison/runner.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <system_error>

#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxScenes = 200;

/// Quotes a text as one word of a shell command.
std::string quoted(const std::string& word) {
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

}  // namespace

EchoFloor measure_echo_floor(std::span<const AnnotatedScene> scenes) {
    std::error_code failure;
    const fs::path program = fs::read_symlink("/proc/self/exe", failure);
    if (failure) return {};
    const std::size_t step = std::max<std::size_t>(1, (scenes.size() + kMaxScenes - 1) / kMaxScenes);
    std::vector<AnnotatedScene> some;
    for (std::size_t i = 0; i < scenes.size(); i += step) some.push_back(scenes[i]);
    RunOptions options;
    options.show_progress = false;
    EchoFloor floor;
    const Method echo = parse_method("exec:echo=exec " + quoted(program.string()) + " echo");
    for (const LaneRecord& record : run(echo, some, options)) {
        if (record.answer.status == LaneStatus::none) floor.push_back(record.latency_ms);
    }
    return floor;
}

EchoFloor read_echo_floor(const fs::path& file) {
    EchoFloor floor;
    if (!fs::exists(file)) return floor;
    with_json_file(file, [&](const JsonNode& json) {
        const JsonNode times = json.member("round_trip_ms");
        const std::size_t size = times.array_size();
        for (std::size_t i = 0; i < size; ++i) floor.push_back(times.element(i).non_negative_number());
    });
    return floor;
}

void write_echo_floor(const fs::path& file, const EchoFloor& floor) {
    AtomicFile output(file);
    output.stream() << nlohmann::json{{"round_trip_ms", floor}}.dump() << '\n';
    output.commit();
}

}  // namespace conelane::experiments
