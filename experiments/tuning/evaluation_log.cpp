#include "experiments/tuning/evaluation_log.hpp"

#include "conelane/rld_parameters.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/input_error.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

/// All that tuning may move.
std::vector<RldParameterField> fields() {
    std::vector<RldParameterField> all;
    for (const auto& some : {rld_parameter_fields(), rld_extra_fields()}) {
        all.insert(all.end(), some.begin(), some.end());
    }
    return all;
}

std::vector<double> key_of(const RldParameters& parameters) {
    std::vector<double> key;
    for (const RldParameterField& field : fields()) key.push_back(parameters.*field.value);
    return key;
}

std::string line_of(const std::vector<double>& key, const std::vector<LapFigure>& laps) {
    nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
    std::size_t i = 0;
    for (const RldParameterField& field : fields()) {
        parameters[std::string(field.key)] = key[i++];
    }
    nlohmann::ordered_json figures = nlohmann::ordered_json::array();
    for (const LapFigure& lap : laps) {
        figures.push_back({{"track", lap.track},
                           {"rate", lap.rate},
                           {"range", lap.range_m},
                           {"scenes", lap.scenes},
                           {"sum", lap.sum}});
    }
    return to_line({{"parameters", parameters}, {"laps", figures}});
}

/// Leaves whole lines of a log with this header. A file of another kind stays as it is. The header may be
/// unfinished, as the last line if the program was stopped while it was written.
void keep_whole_lines(const fs::path& file, const std::string& header) {
    const std::string text = text_of(file);
    const std::size_t end = text.find('\n');
    if (end == std::string::npos ? !header.starts_with(text) : text.substr(0, end) != header)
        throw InputError(file, 1, "", "is the log of another tuning: other sources or options");
    std::error_code failure;
    fs::resize_file(file, text.rfind('\n') + 1, failure);  // npos + 1 is 0
    if (failure) throw InputError(file, 0, "", "cannot be written: " + failure.message());
}

}  // namespace

EvaluationLog::EvaluationLog(fs::path file, const std::string& header, Evaluate evaluate)
    : file_(std::move(file)), evaluate_(std::move(evaluate)) {
    if (file_.empty()) return;
    const bool is_old = fs::exists(file_);
    if (is_old) {
        keep_whole_lines(file_, header);
        read();
    }
    const bool has_header = is_old && fs::file_size(file_) > 0;
    stream_.open(file_, std::ios::binary | std::ios::app);
    if (!stream_)
        throw InputError(file_, 0, "", "cannot be written: " + std::generic_category().message(errno));
    if (!has_header) stream_ << header << std::endl;
    stream_.require_written(file_);
}

void EvaluationLog::read() {
    for_each_json_line(file_, [&](const JsonNode& json) {
        if (json.line() == 1) return;
        const JsonNode parameters = json.member("parameters");
        std::vector<double> key;
        for (const RldParameterField& field : fields()) {
            key.push_back(parameters.member(field.key).number());
        }
        std::vector<LapFigure> laps;
        const JsonNode figures = json.member("laps");
        for (std::size_t i = 0; i < figures.array_size(); ++i) {
            const JsonNode lap = figures.element(i);
            laps.push_back({lap.member("track").string(), lap.member("rate").number(),
                            lap.member("range").number(), lap.member("scenes").unsigned_integer(),
                            lap.member("sum").non_negative_number()});
        }
        figures_.insert_or_assign(std::move(key), std::move(laps));
    });
}

std::vector<LapFigure> EvaluationLog::operator()(const RldParameters& parameters) {
    std::vector<double> key = key_of(parameters);
    if (const auto known = figures_.find(key); known != figures_.end()) return known->second;
    std::vector<LapFigure> laps = evaluate_(parameters);
    if (!file_.empty()) {
        stream_ << line_of(key, laps) << std::endl;
        stream_.require_written(file_);
    }
    figures_.emplace(std::move(key), laps);
    return laps;
}

}  // namespace conelane::experiments
