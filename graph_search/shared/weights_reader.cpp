#include "graph_search/shared/weights_reader.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/shared/json_reader.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

namespace conelane {
namespace {

/// What errors say of the list `features.state` below the key `features`: `'state' `.
std::string list_below(const std::string& path) {
    const std::size_t dot = path.find('.');
    return dot == std::string::npos ? "" : "'" + path.substr(dot + 1) + "' ";
}

constexpr const char* kOtherVersion = ": the weights are of another version";

std::string numbered(std::size_t place, const char* fault) {
    return "number " + std::to_string(place) + " (from 0) " + fault;
}

#ifdef __wasi__  // a WebAssembly module has no files: weights come as bytes
std::string weights_bytes(const std::filesystem::path& /*file*/) {
    throw InvalidInput("weights", "cannot be read");
}
#else
std::string weights_bytes(const std::filesystem::path& file) {
    constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;  // the shipped file has 0.13 MB
    std::ifstream stream(file, std::ios::binary);
    std::string bytes(1U << 16U, '\0');
    std::size_t size = 0;
    while (stream && size <= kMaxBytes) {
        if (size == bytes.size()) bytes.resize(2 * bytes.size());
        stream.read(bytes.data() + size, static_cast<std::streamsize>(bytes.size() - size));
        size += static_cast<std::size_t>(stream.gcount());
    }
    if (!stream.eof()) throw InvalidInput("weights", size > kMaxBytes ? "is too large" : "cannot be read");
    bytes.resize(size);
    return bytes;
}
#endif

}  // namespace

WeightsReader::WeightsReader(std::string_view text, std::string_view what, std::string_view command)
    : text_(text) {
    JsonReader json(text, what);
    if (json.next() != '{') json.fail("must be a JSON object, as `" + std::string(command) + "` writes it");
    json.object([&](const std::string& key) { read(json, key); });
    json.require_end();
}

void WeightsReader::read(JsonReader& json, const std::string& path) {
    Value value;
    const char first = json.next();
    if (path == "training") {
        const std::size_t begin = json.position();
        json.skip();
        training_ = text_.substr(begin, json.position() - begin);
        value.is_used = true;
    } else if (first == '{') {
        json.object([&](const std::string& key) { read(json, path + "." + key); });
    } else if (first == '[') {
        value.is_list = true;
        json.array([&] { read_element(json, path, value); });
    } else if (json.is_number()) {
        value.numbers.push_back(json.number());
    } else {
        json.skip();
    }
    if (!values_.emplace(path, std::move(value)).second) throw InvalidInput(path, "is there twice");
}

void WeightsReader::read_element(JsonReader& json, const std::string& path, Value& list) {
    const std::size_t place = list.size++;
    if (json.is_number()) {
        list.numbers.push_back(json.number());
        if (list.first_other == place) ++list.first_other;
        return;
    }
    const char first = json.next();
    if (first == '"') {
        list.names.push_back(json.string());
    } else if (first == '[' || first == '{') {
        read(json, path + "[" + std::to_string(place) + "]");
    } else if (std::string_view("tfn").find(first) != std::string_view::npos) {
        json.skip();
    } else {
        throw InvalidInput(path, numbered(place, "is not a number"));
    }
}

const WeightsReader::Value& WeightsReader::find(const std::string& path) {
    // The first part that is missing names the fault; those above it are in use.
    for (std::size_t end = 0; end != std::string::npos;) {
        end = path.find_first_of(".[", end + 1);
        const auto part = values_.find(path.substr(0, end));
        if (part == values_.end()) throw InvalidInput(path.substr(0, end), "is missing");
        part->second.is_used = true;
    }
    return values_.find(path)->second;
}

int WeightsReader::version(std::initializer_list<int> known) {
    const Value& value = find("version");
    std::string list;
    for (const int version : known) {
        if (!value.is_list && value.numbers == std::vector<double>{static_cast<double>(version)})
            return version;
        list += (list.empty() ? "" : version == *(known.end() - 1) ? " or " : ", ") + std::to_string(version);
    }
    throw InvalidInput("version", "must be " + list);
}

std::string_view WeightsReader::training() {
    (void)find("training");
    return training_;
}

double WeightsReader::number(const std::string& path) {
    const Value& value = find(path);
    if (value.is_list || value.numbers.empty()) throw InvalidInput(path, "must be a number");
    return value.numbers.front();
}

const std::vector<double>& WeightsReader::numbers(const std::string& path) {
    const Value& value = find(path);
    if (!value.is_list) throw InvalidInput(path, "must be a list of numbers");
    if (value.first_other < value.size)
        throw InvalidInput(path, numbered(value.first_other, "is not a number"));
    return value.numbers;
}

std::vector<float> WeightsReader::floats(const std::string& path, std::size_t count) {
    std::vector<float> result;
    for (const double number : numbers(path)) {
        constexpr double kMax = 1e6;  // what larger ones add up to may be infinite
        if (std::abs(number) > kMax)
            throw InvalidInput(path, numbered(result.size(), "is not between -1e6 and 1e6"));
        result.push_back(static_cast<float>(number));
    }
    if (result.size() != count)
        throw InvalidInput(path,
                           "has " + std::to_string(result.size()) + " numbers, not " + std::to_string(count));
    return result;
}

std::size_t WeightsReader::first_names(const std::string& path, std::span<const std::string_view> known) {
    const std::vector<std::string>& names = find(path).names;
    if (names.size() != find(path).size) throw InvalidInput(path, "must be a list of names");
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (i < known.size() && names[i] == known[i]) continue;
        throw InvalidInput(path.substr(0, path.find('.')), list_below(path) + "has '" + names[i] +
                                                               "' at place " + std::to_string(i) +
                                                               ", unlike the library" + kOtherVersion);
    }
    return names.size();
}

void WeightsReader::require_names(const std::string& path, std::span<const std::string_view> known) {
    const std::size_t count = first_names(path, known);
    if (count != known.size())
        throw InvalidInput(path.substr(0, path.find('.')), list_below(path) + "has " + std::to_string(count) +
                                                               " names, not " + std::to_string(known.size()) +
                                                               " as the library" + kOtherVersion);
}

void WeightsReader::require_no_other(std::string_view of) const {
    for (const auto& [path, value] : values_) {
        if (!value.is_used) throw InvalidInput(path, "is not a key of " + std::string(of));
    }
}

void with_weights_file(const std::filesystem::path& file,
                       const std::function<void(std::string_view)>& parse) {
    try {
        parse(weights_bytes(file));
    } catch (const InvalidInput& error) {
        const std::string what = error.what();
        const std::string prefix = "weights: ";
        throw InvalidInput(
            "weights", file.string() + ": " + (what.starts_with(prefix) ? what.substr(prefix.size()) : what));
    }
}

}  // namespace conelane
