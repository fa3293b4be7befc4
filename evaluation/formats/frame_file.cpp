#include "evaluation/formats/frame_file.hpp"

#include "evaluation/formats/cone_json.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/run_log.hpp"
#include "evaluation/input_error.hpp"

#include <string_view>
#include <utility>

namespace conelane {
namespace {

Cone read_cone(const JsonNode& json) {
    Cone cone;
    cone.id = kNoId;
    if (const auto id = json.find("id")) cone.id = id->integer();
    cone.position = {json.member("x").number(), json.member("y").number()};
    read_color(json, cone);
    read_covariance(json, cone);
    if (const auto confidence = json.find("confidence")) cone.confidence = confidence->number();
    return cone;
}

Frame read_own_frame(const JsonNode& json) {
    Frame frame;
    const JsonNode pose = json.member("pose");
    frame.pose.position = {pose.member("x").number(), pose.member("y").number()};
    frame.pose.yaw_rad = pose.member("yaw").number();
    const JsonNode cones = json.member("cones");
    const std::size_t size = cones.array_size();
    frame.cones.reserve(size);
    for (std::size_t i = 0; i < size; ++i) frame.cones.push_back(read_cone(cones.element(i)));
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
    std::size_t number = 0;
    for (std::string text; std::getline(stream, text);) {
        ++number;
        if (is_blank(text)) continue;
        FrameLine line{number, {}, false, {}};
        try {
            with_json_line(text, "", number, [&](const JsonNode& json) { line = reader.read(json, number); });
        } catch (const InputError& error) {
            line.fault = error.what();
        }
        use(line);
    }
}

}  // namespace conelane
