#include "graph_search/front/front_weights_reader.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/front/front_features.hpp"
#include "graph_search/front/front_judge_features.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <limits>
#include <locale>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace conelane {
namespace {

constexpr double kVersion = 1.0;
/// Of nested values; the recursion is as deep.
constexpr int kMaxDepth = 64;

/// The double nearest to a number of JSON; infinite where it is out of range.
double double_of(std::string_view number) {
    double value = 0.0;
#if defined(__cpp_lib_to_chars)
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (error == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
#else  // libc++ before version 20 reads no doubles so
    std::istringstream stream{std::string(number)};
    stream.imbue(std::locale::classic());
    if (!(stream >> value)) return std::numeric_limits<double>::infinity();
#endif
    return value;
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

bool is_hex_digit(char c) {
    return is_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}

/// Reads JSON from front to back. The core has no JSON library, and needs no more than this.
class JsonReader {
  public:
    explicit JsonReader(std::string_view text) : text_(text) {}

    [[noreturn]] void fail(const std::string& reason) const {
        const auto line = 1 + std::ranges::count(text_.substr(0, std::min(at_, text_.size())), '\n');
        throw InvalidInput("weights", "line " + std::to_string(line) + ": " + reason);
    }

    /// What the next value begins with; 0 at the end.
    [[nodiscard]] char next() {
        pass_blanks();
        return peek();
    }
    void require_end() {
        pass_blanks();
        if (at_ < text_.size()) fail("there is more behind the object");
    }

    /// Calls `read(key)` at each value of an object.
    template <typename Read>
    void object(const Read& read) {
        list('{', '}', [&] {
            const std::string key = string();
            expect(':');
            read(key);
        });
    }
    /// Calls `read()` at each value of an array.
    template <typename Read>
    void array(const Read& read) {
        list('[', ']', read);
    }

    /// With its escapes as they stand: no name that is compared has one.
    std::string string() {
        expect('"');
        const std::size_t begin = at_;
        while (true) {
            const char c = character();
            if (c == '"') return std::string(text_.substr(begin, at_ - 1 - begin));
            if (static_cast<unsigned char>(c) < 0x20) fail("a string holds a control character");
            if (c == '\\') escape();
        }
    }

    [[nodiscard]] bool is_number() {
        const char c = next();
        return c == '-' || is_digit(c);
    }
    /// Infinite where it is out of the range of a double.
    double number() {
        pass_blanks();
        const std::size_t begin = at_;
        if (peek() == '-') ++at_;
        if (peek() == '0') {
            ++at_;
        } else {
            digits();
        }
        if (peek() == '.') {
            ++at_;
            digits();
        }
        if (peek() == 'e' || peek() == 'E') {
            ++at_;
            if (peek() == '+' || peek() == '-') ++at_;
            digits();
        }
        return double_of(text_.substr(begin, at_ - begin));
    }

    /// Passes over any value.
    void skip(int depth = 0) {
        if (depth > kMaxDepth) fail("values are nested too deep");
        const char c = next();
        if (c == '{') {
            object([&](const std::string&) { skip(depth + 1); });
        } else if (c == '[') {
            array([&] { skip(depth + 1); });
        } else if (c == '"') {
            (void)string();
        } else if (is_number()) {
            (void)number();
        } else {
            word();
        }
    }

  private:
    void pass_blanks() {
        while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
            ++at_;
    }

    [[nodiscard]] char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

    char character() {
        if (at_ >= text_.size()) fail("the file ends in the middle");
        return text_[at_++];
    }

    void expect(char wanted) {
        if (next() == wanted && at_ < text_.size()) {
            ++at_;
            return;
        }
        if (at_ >= text_.size()) fail("the file ends in the middle");
        fail(std::string("expected '") + wanted + "'");
    }

    template <typename Read>
    void list(char open, char close, const Read& read) {
        expect(open);
        if (next() == close) {
            ++at_;
            return;
        }
        while (true) {
            read();
            if (next() == close) break;
            expect(',');
        }
        ++at_;
    }

    void escape() {
        const char c = character();
        if (c == 'u') {
            for (int i = 0; i < 4; ++i) {
                if (!is_hex_digit(character())) fail("\\u needs four hexadecimal digits");
            }
        } else if (std::string_view("\"\\/bfnrt").find(c) == std::string_view::npos) {
            fail("a string holds an unknown escape");
        }
    }

    void digits() {
        if (!is_digit(peek())) fail("a number is incomplete");
        while (is_digit(peek())) ++at_;
    }

    void word() {
        for (const std::string_view known : {"true", "false", "null"}) {
            if (!text_.substr(at_).starts_with(known)) continue;
            at_ += known.size();
            return;
        }
        if (at_ >= text_.size()) fail("the file ends in the middle");
        fail("expected a value");
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

struct FeatureList {
    std::string_view key;
    std::span<const FrontFeature> features;
};
std::array<FeatureList, 6> feature_lists() {
    return {{{"state", state_feature_table()},
             {"extend", extend_feature_table()},
             {"stop", stop_feature_table()},
             {"start", start_feature_table()},
             {"cone", cone_feature_table()},
             {"lane", whole_lane_feature_table()}}};
}

/// The inputs have to be those that the library computes, in their order.
void read_features(JsonReader& json) {
    if (json.next() != '{') throw InvalidInput("features", "must be an object of lists of names");
    std::set<std::string> seen;
    json.object([&](const std::string& key) {
        const auto lists = feature_lists();
        const auto known = std::ranges::find(lists, key, &FeatureList::key);
        if (known == lists.end()) throw InvalidInput("features", "'" + key + "' is no list of the library");
        if (!seen.insert(key).second) throw InvalidInput("features", "'" + key + "' is there twice");
        if (json.next() != '[') throw InvalidInput("features", "'" + key + "' must be a list of names");
        std::size_t count = 0;
        json.array([&] {
            if (json.next() != '"') throw InvalidInput("features", "'" + key + "' must hold names");
            const std::string name = json.string();
            if (count >= known->features.size() || known->features[count].name != name) {
                throw InvalidInput("features",
                                   "'" + key + "' has '" + name + "' at place " + std::to_string(count) +
                                       ", unlike the library: the weights are of another version");
            }
            ++count;
        });
        if (count != known->features.size())
            throw InvalidInput("features", "'" + key + "' has " + std::to_string(count) + " names, not " +
                                               std::to_string(known->features.size()) +
                                               " as the library: the weights are of another version");
    });
    for (const FeatureList& list : feature_lists()) {
        if (!seen.contains(std::string(list.key)))
            throw InvalidInput("features", "'" + std::string(list.key) + "' is missing");
    }
}

void read_numbers(JsonReader& json, const std::string& key, std::span<float> numbers) {
    const auto fail = [&](const std::string& reason) { throw InvalidInput(key, reason); };
    const std::string size = std::to_string(numbers.size());
    if (json.next() != '[') fail("must be a list of " + size + " numbers");
    std::size_t count = 0;
    json.array([&] {
        const std::string place = "number " + std::to_string(count);
        if (!json.is_number()) fail(place + " (from 0) is no number");
        const double number = json.number();
        if (std::abs(number) > static_cast<double>(std::numeric_limits<float>::max()))
            fail(place + " (from 0) is out of range");
        if (count < numbers.size()) numbers[count] = static_cast<float>(number);
        ++count;
    });
    if (count != numbers.size()) fail("has " + std::to_string(count) + " numbers, not " + size);
}

struct NumberList {
    std::string key;
    std::span<float> numbers;
};

/// All lists of numbers of a file.
std::vector<NumberList> number_lists(FrontWeights& weights) {
    std::vector<NumberList> lists;
    const auto add = [&lists](const std::string& name, FrontNetworkWeights& network) {
        lists.push_back({name + "_hidden", network.hidden});
        lists.push_back({name + "_hidden_bias", network.hidden_bias});
        lists.push_back({name + "_output", network.output});
        lists.push_back({name + "_linear", network.linear});
        lists.push_back({name + "_output_bias", std::span(&network.output_bias, 1)});
    };
    add("extend", weights.extend);
    add("stop", weights.stop);
    add("start", weights.start);
    add("rank", weights.rank);
    add("usable", weights.usable);
    add("right", weights.right);
    return lists;
}

double read_number(JsonReader& json, const std::string& key) {
    if (!json.is_number()) throw InvalidInput(key, "must be a number");
    return json.number();
}

#ifdef __wasi__  // a WebAssembly module has no files: weights come as bytes
std::string bytes_of(const std::filesystem::path& /*file*/) {
    throw InvalidInput("weights", "cannot be read");
}
#else
std::string bytes_of(const std::filesystem::path& file) {
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

FrontWeights parse_front_weights(std::string_view text) {
    JsonReader json(text);
    if (json.next() != '{') json.fail("must be a JSON object, as `conelane train front` writes it");
    FrontWeights weights = FrontWeights::zero();
    const std::vector<NumberList> lists = number_lists(weights);
    std::set<std::string> seen;
    std::string unknown;
    json.object([&](const std::string& key) {
        if (!seen.insert(key).second) throw InvalidInput(key, "is there twice");
        const auto list = std::ranges::find(lists, key, &NumberList::key);
        if (list != lists.end()) {
            read_numbers(json, key, list->numbers);
        } else if (key == "version") {
            if (read_number(json, key) != kVersion) throw InvalidInput(key, "must be 1");
        } else if (key == "features") {
            read_features(json);
        } else if (key == "least_trust") {
            weights.least_trust = read_number(json, key);
        } else {
            if (key != "training" && unknown.empty()) unknown = key;
            json.skip();
        }
    });
    json.require_end();
    const auto require = [&seen](const std::string& key) {
        if (!seen.contains(key)) throw InvalidInput(key, "is missing");
    };
    require("version");
    require("features");
    for (const NumberList& list : lists) require(list.key);
    require("least_trust");
    if (!unknown.empty()) throw InvalidInput(unknown, "is no key of weights of front");
    validate(weights);
    return weights;
}

FrontWeights read_front_weights(const std::filesystem::path& file) {
    try {
        return parse_front_weights(bytes_of(file));
    } catch (const InvalidInput& error) {
        const std::string what = error.what();
        const std::string prefix = "weights: ";
        throw InvalidInput(
            "weights", file.string() + ": " + (what.starts_with(prefix) ? what.substr(prefix.size()) : what));
    }
}

}  // namespace conelane
