#include "evaluation/formats/track_readers.hpp"

#include "evaluation/formats/cone_table.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/world/track_checks.hpp"

#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

namespace conelane {
namespace {

/// A YAML file. Errors name file, line and key.
class YamlFile {
  public:
    explicit YamlFile(const std::filesystem::path& file) : file_(file) {
        const std::string content = text_of(file);
        try {
            root_ = YAML::Load(content);
        } catch (const YAML::Exception& exception) {
            throw InputError(file_, line(exception.mark), "", "not YAML: " + exception.msg);
        }
    }

    [[nodiscard]] YAML::Node root() const { return root_; }

    [[noreturn]] void fail(const YAML::Node& node, const std::string& key, const std::string& reason) const {
        throw InputError(file_, line(node.Mark()), key, reason);
    }

    void require_map(const YAML::Node& node, const std::string& key) const {
        if (!node.IsMap()) fail(node, key, "is not a map");
    }

    /// The value of `key`, spelled `path` in errors, in the map `parent`.
    [[nodiscard]] YAML::Node required(const YAML::Node& parent, const std::string& key,
                                      const std::string& path) const {
        const YAML::Node value = parent[key];
        if (!value) fail(parent, path, "missing");
        return value;
    }

    [[nodiscard]] YAML::Node sequence(const YAML::Node& node, const std::string& key) const {
        if (!node.IsSequence()) fail(node, key, "is not a list");
        return node;
    }

    template <typename Value>
    [[nodiscard]] Value value(const YAML::Node& node, const std::string& key, const char* expected) const {
        Value result{};
        if (!node.IsScalar() || !YAML::convert<Value>::decode(node, result)) {
            fail(node, key, fmt::format("is not {}", expected));
        }
        return result;
    }

    [[nodiscard]] double coordinate(const YAML::Node& node, const std::string& key) const {
        const auto result = value<double>(node, key, "a number");
        if (const std::string fault = coordinate_fault(result); !fault.empty()) fail(node, key, fault);
        return result;
    }

    /// x and y of a list of `fewest` to `most` numbers.
    [[nodiscard]] Point position(const YAML::Node& node, const std::string& key, std::size_t fewest,
                                 std::size_t most) const {
        if (!node.IsSequence() || node.size() < fewest || node.size() > most) {
            fail(node, key, most == 2 ? "is not [x, y]" : "is not [x, y, z]");
        }
        for (std::size_t axis = 2; axis < node.size(); ++axis) {
            static_cast<void>(coordinate(node[axis], fmt::format("{}[{}]", key, axis)));
        }
        return {coordinate(node[0], key + "[0]"), coordinate(node[1], key + "[1]")};
    }

  private:
    static std::size_t line(const YAML::Mark& mark) {
        return mark.is_null() ? 0 : static_cast<std::size_t>(mark.line) + 1;
    }

    std::filesystem::path file_;
    YAML::Node root_;
};

/// Appends the cones of a PacSim lane to the track and returns their indices.
std::vector<std::size_t> append_pacsim_cones(const YamlFile& yaml, const YAML::Node& list,
                                             const std::string& key, Track& track) {
    std::vector<std::size_t> indices;
    for (const YAML::Node& item : yaml.sequence(list, key)) {
        const std::string item_key = fmt::format("{}[{}]", key, indices.size());
        yaml.require_map(item, item_key);
        const std::string position_key = item_key + ".position";
        const std::string class_key = item_key + ".class";
        Cone cone;
        cone.id = static_cast<ConeId>(track.cones.size());
        cone.position = yaml.position(yaml.required(item, "position", position_key), position_key, 2, 3);
        const auto class_name =
            yaml.value<std::string>(yaml.required(item, "class", class_key), class_key, "a class name");
        cone.color = color_named(class_name).value_or(ConeColor::unknown);
        indices.push_back(track.cones.size());
        track.cones.push_back(cone);
    }
    return indices;
}

}  // namespace

Track read_fsd_track(const std::filesystem::path& directory, int number) {
    Track track;
    track.name = fmt::format("fsd_{}", number);
    track.closed = true;

    const YamlFile map(directory / fmt::format("cone_map_{}.yaml", number));
    map.require_map(map.root(), "");
    std::unordered_map<ConeId, std::size_t> index_of;
    for (const auto& entry : map.root()) {
        const auto id = map.value<ConeId>(entry.first, "id", "an integer");
        if (!index_of.emplace(id, track.cones.size()).second) {
            map.fail(entry.first, std::to_string(id), "id is there twice");
        }
        Cone cone;
        cone.id = id;
        cone.position = map.position(entry.second, std::to_string(id), 2, 2);
        track.cones.push_back(cone);
    }

    const std::filesystem::path boundaries_path = directory / fmt::format("boundaries_{}.yaml", number);
    const YamlFile boundaries_file(boundaries_path);
    boundaries_file.require_map(boundaries_file.root(), "");
    std::unordered_set<ConeId> used;
    const auto read_boundary = [&](const std::string& key) {
        const YAML::Node ids =
            boundaries_file.sequence(boundaries_file.required(boundaries_file.root(), key, key), key);
        std::vector<std::size_t> boundary;
        for (std::size_t position = 0; position < ids.size(); ++position) {
            const std::string item_key = fmt::format("{}[{}]", key, position);
            const auto id = boundaries_file.value<ConeId>(ids[position], item_key, "an integer");
            const auto found = index_of.find(id);
            if (found == index_of.end()) {
                boundaries_file.fail(ids[position], item_key, fmt::format("no cone has id {}", id));
            }
            const bool closes =
                position > 0 && position + 1 == ids.size() && found->second == boundary.front();
            if (closes) break;
            if (!used.insert(id).second) {
                boundaries_file.fail(ids[position], item_key, fmt::format("id {} is there twice", id));
            }
            boundary.push_back(found->second);
        }
        return boundary;
    };
    track.left = read_boundary("left");
    track.right = read_boundary("right");
    track = without_doubled_cones(std::move(track));
    require_enough_cones(track, boundaries_path);
    return track;
}

Track read_pacsim_track(const std::filesystem::path& file) {
    Track track;
    track.name = "pacsim_" + file.stem().string();

    const YamlFile yaml(file);
    yaml.require_map(yaml.root(), "");
    const YAML::Node root = yaml.required(yaml.root(), "track", "track");
    yaml.require_map(root, "track");
    const std::string closed_key = "track.lanesFirstWithLastConnected";
    track.closed = yaml.value<bool>(yaml.required(root, "lanesFirstWithLastConnected", closed_key),
                                    closed_key, "true or false");
    track.left = append_pacsim_cones(yaml, yaml.required(root, "left", "track.left"), "track.left", track);
    track.right =
        append_pacsim_cones(yaml, yaml.required(root, "right", "track.right"), "track.right", track);
    const YAML::Node unknown = root["unknown"];
    if (unknown && !unknown.IsNull()) append_pacsim_cones(yaml, unknown, "track.unknown", track);
    track = without_doubled_cones(std::move(track));
    require_enough_cones(track, file);
    return track;
}

constexpr TrackFormat kPacsimTracks{
    .word = "pacsim", .what = "FILE", .reads = "PacSim, YAML", .ending = ".yaml", .read = read_pacsim_track};

}  // namespace conelane
