#include "experiments/training/training_checkpoint.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/input_error.hpp"

#include <filesystem>
#include <vector>

namespace conelane::experiments {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;

Json numbers(const Eigen::ArrayXd& values) {
    return std::vector<double>(values.begin(), values.end());
}

Eigen::ArrayXd array(const JsonNode& node, Eigen::Index size) {
    if (node.array_size() != static_cast<std::size_t>(size))
        node.fail("must have " + std::to_string(size) + " numbers");
    Eigen::ArrayXd result(size);
    for (Eigen::Index i = 0; i < size; ++i) result[i] = node.element(static_cast<std::size_t>(i)).number();
    return result;
}

}  // namespace

std::optional<TrainingCheckpoint> read_training_checkpoint(const std::string& file,
                                                           const std::string& identity, Eigen::Index size) {
    if (!std::filesystem::exists(file)) return std::nullopt;
    TrainingCheckpoint checkpoint;
    with_json_file(file, [&](const JsonNode& node) {
        if (node.member("version").integer() != kVersion)
            node.member("version").fail("must be " + std::to_string(kVersion));
        if (node.member("training").string() != identity) {
            node.member("training").fail("is another training than the one asked for");
        }
        checkpoint.step = node.member("step").unsigned_integer();
        checkpoint.values = array(node.member("values"), size);
        checkpoint.adam.first = array(node.member("first"), size);
        checkpoint.adam.second = array(node.member("second"), size);
        checkpoint.adam.first_power = node.member("first_power").number();
        checkpoint.adam.second_power = node.member("second_power").number();
    });
    return checkpoint;
}

void write_training_checkpoint(const std::string& file, const std::string& identity,
                               const TrainingCheckpoint& checkpoint) {
    const Json json{{"version", kVersion},
                    {"training", identity},
                    {"step", checkpoint.step},
                    {"values", numbers(checkpoint.values)},
                    {"first", numbers(checkpoint.adam.first)},
                    {"second", numbers(checkpoint.adam.second)},
                    {"first_power", checkpoint.adam.first_power},
                    {"second_power", checkpoint.adam.second_power}};
    AtomicFile output(file);
    output.stream() << json.dump() << '\n';
    output.commit();
}

}  // namespace conelane::experiments
