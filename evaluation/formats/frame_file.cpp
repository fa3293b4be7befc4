#include "evaluation/formats/frame_file.hpp"

#include "evaluation/formats/cone_json.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/run_log.hpp"

namespace conelane {
namespace {

constexpr std::tuple kConeOfFrame =
    std::tuple_cat(std::tuple{Field{"id", &Cone::id, Absent::when_read}}, kSeenCone);

Frame read_own_frame(const JsonNode& json) {
    Frame frame;
    read_value(json.member("pose"), frame.pose);
    const JsonNode cones = json.member("cones");
    frame.cones.resize(cones.array_size(), Cone{.id = kNoId});
    for (std::size_t i = 0; i < frame.cones.size(); ++i)
        read_fields(cones.element(i), frame.cones[i], kConeOfFrame);
    return frame;
}

/// Reads frames one after another, each with its time.
class FrameReader {
  public:
    explicit FrameReader(double interval_s) : interval_s_(interval_s) {}

    FrameLine read(const JsonNode& json, std::size_t number) {
        FrameLine line{number, {}, false, {}};
        const auto reset = json.find("reset");
        line.reset = reset && reset->boolean();
        if (line.reset) {
            last_s_.reset();
            return line;
        }
        Frame frame = json.find("car_position") ? read_run_frame(json) : read_own_frame(json);
        frame.time_s = last_s_ ? *last_s_ + interval_s_ : 0.0;
        if (const auto time_s = json.find("time_s")) frame.time_s = time_s->number();
        last_s_ = frame.time_s;
        line.frame = std::move(frame);
        return line;
    }

  private:
    double interval_s_;
    std::optional<double> last_s_;
};

bool is_list(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && text[first] == '[';
}

}  // namespace

std::vector<FrameLine> read_frames(const std::filesystem::path& file, double interval_s) {
    std::vector<FrameLine> lines;
    FrameReader reader(interval_s);
    bool any = false;
    const auto add = [&](const JsonNode& json, std::size_t number) {
        lines.push_back(reader.read(json, number));
        any = any || lines.back().frame;
    };
    if (is_list(text_of(file))) {
        with_json_list_file(file, [&](const JsonNode& list) {
            const std::size_t size = list.array_size();
            for (std::size_t i = 0; i < size; ++i) add(list.element(i), i + 1);
        });
    } else {
        for_each_json_line(file, [&](const JsonNode& json) { add(json, json.line()); });
    }
    if (!any) throw InputError(file, 0, "", "holds no frame");
    return lines;
}

void for_each_frame_line(std::istream& stream, double interval_s,
                         const std::function<void(const FrameLine&)>& use) {
    FrameReader reader(interval_s);
    const auto read = [&](const JsonNode& json, FrameLine& line) { line = reader.read(json, json.line()); };
    for_each_stream_line<FrameLine>(stream, read, use);
}

}  // namespace conelane
