#include "evaluation/formats/left_out_scenes.hpp"

#include "evaluation/formats/json_node.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>

#include <fmt/format.h>

namespace conelane {

LeftOutScenes read_left_out(const std::filesystem::path& companion) {
    LeftOutScenes left_out;
    with_json_file(companion, [&](const JsonNode& json) {
        for (const std::string& name : json.keys()) {
            const auto ids = json.member(name).find("left_out");
            if (!ids) continue;
            for (std::size_t i = 0; i < ids->array_size(); ++i)
                left_out[name].push_back(ids->element(i).string());
        }
    });
    return left_out;
}

void merge(LeftOutScenes& left_out, const LeftOutScenes& of_shard) {
    for (const auto& [track, ids] : of_shard) {
        std::vector<std::string>& all = left_out[track];
        std::ranges::copy(ids, std::back_inserter(all));
        std::ranges::sort(all);
    }
}

std::string note_on(const LeftOutScenes& left_out) {
    std::size_t count = 0;
    std::string first;
    for (const auto& [track, ids] : left_out) {
        if (count == 0 && !ids.empty()) first = ids.front();
        count += ids.size();
    }
    if (count == 0) return "";
    return fmt::format("{} left out: the ground truth is degenerate; the first is {}",
                       count == 1 ? "1 scene is" : fmt::format("{} scenes are", count), first);
}

std::string table_note_on(const LeftOutScenes& left_out) {
    const std::string note = note_on(left_out);
    return note.empty() ? "" : "    " + note + "\n";
}

}  // namespace conelane
