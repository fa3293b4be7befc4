// Records of files by their fields: one list says how a record is read, validated and written.
#pragma once

#include "conelane/point.hpp"
#include "conelane/stop_reason.hpp"
#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/parameter_file.hpp"
#include "evaluation/input_error.hpp"

#include <istream>
#include <map>
#include <tuple>
#include <type_traits>

namespace conelane {

/// The fields of a record, a std::tuple of Field, Inlined and types with the same two functions, in the order
/// in which they are written. Each record of a file specialises it.
template <typename Record>
inline constexpr int kFields = 0;
template <typename Record>
concept HasFields = !std::same_as<decltype(kFields<Record>), const int>;

/// The values of an enum that a file spells as `to_string` does.
template <typename Choice>
struct Choices;
template <>
struct Choices<StopReason> {
    static constexpr std::array all{StopReason::time, StopReason::iterations, StopReason::memory};
};
template <>
struct Choices<Pairing> {
    static constexpr std::array all{Pairing::near_far, Pairing::paper};
};

/// What a number may be.
enum class Range { any, not_negative, positive, share };
/// Where a member may be absent: in no record; in what is read, which then keeps its default; also in what is
/// written, if it is empty or false. A std::optional may always be absent.
enum class Absent { never, when_read, if_empty };

template <typename Record, typename Fields>
void read_fields(const JsonNode& json, Record& record, const Fields& fields) {
    std::apply([&](const auto&... field) { (field.read(json, record), ...); }, fields);
}

/// `place` names the record in errors, such as "lanes[3].".
template <typename Record, typename Fields>
void put_fields(nlohmann::ordered_json& json, const Record& record, const Fields& fields,
                const std::string& place) {
    std::apply([&](const auto&... field) { (field.put(json, record, place), ...); }, fields);
}

template <typename Value>
inline constexpr bool kIsList = false;
template <typename Element>
inline constexpr bool kIsList<std::vector<Element>> = true;
template <typename Value>
inline constexpr bool kIsPair = false;
template <typename First, typename Second>
inline constexpr bool kIsPair<std::pair<First, Second>> = true;
template <typename Value>
inline constexpr bool kIsOptional = false;
template <typename Value>
inline constexpr bool kIsOptional<std::optional<Value>> = true;

template <typename Value>
void read_value(const JsonNode& json, Value& value, Range range = Range::any) {
    if constexpr (kIsOptional<Value>) {
        read_value(json, value.emplace(), range);
    } else if constexpr (kIsList<Value>) {
        const std::size_t size = json.array_size();
        value.reserve(size);
        for (std::size_t i = 0; i < size; ++i) read_value(json.element(i), value.emplace_back(), range);
    } else if constexpr (kIsPair<Value>) {
        if (json.array_size() != 2) json.fail("must be a pair of numbers");
        read_value(json.element(0), value.first);
        read_value(json.element(1), value.second);
    } else if constexpr (std::same_as<Value, Point>) {
        if (json.array_size() != 2) json.fail("must be [x, y]");
        value = {json.element(0).number(), json.element(1).number()};
    } else if constexpr (HasFields<Value>) {
        json.require_object();
        read_fields(json, value, kFields<Value>);
    } else if constexpr (std::is_enum_v<Value>) {
        value = json.one_of(Choices<Value>::all);
    } else if constexpr (std::same_as<Value, double>) {
        value = range == Range::share          ? json.number_in(0.0, 1.0)
                : range == Range::not_negative ? json.non_negative_number()
                                               : json.number();
    } else if constexpr (std::same_as<Value, bool>) {
        value = json.boolean();
    } else if constexpr (std::unsigned_integral<Value>) {
        value = static_cast<Value>(json.unsigned_integer());
        if (range == Range::positive && value == 0) json.fail("must be at least 1");
    } else if constexpr (std::same_as<Value, std::int64_t>) {
        value = range == Range::not_negative ? json.non_negative_integer() : json.integer();
    } else {
        value = json.string();
    }
}

/// Throws InvalidInput naming `key` if a number is not finite.
template <typename Value>
nlohmann::ordered_json value_json(const Value& value, const std::string& key) {
    using nlohmann::ordered_json;
    if constexpr (kIsList<Value>) {
        ordered_json json = ordered_json::array();
        for (const auto& element : value) json.push_back(value_json(element, key));
        return json;
    } else if constexpr (kIsPair<Value>) {
        return ordered_json::array({value_json(value.first, key), value_json(value.second, key)});
    } else if constexpr (std::same_as<Value, Point>) {
        return ordered_json::array({require_finite(value.x(), key), require_finite(value.y(), key)});
    } else if constexpr (HasFields<Value>) {
        ordered_json json = ordered_json::object();
        put_fields(json, value, kFields<Value>, key + ".");
        return json;
    } else if constexpr (std::is_enum_v<Value>) {
        return to_string(value);
    } else if constexpr (std::same_as<Value, double>) {
        return require_finite(value, key);
    } else {
        return value;
    }
}

template <typename Value>
bool is_empty(const Value& value) {
    if constexpr (requires { value.empty(); }) {
        return value.empty();
    } else if constexpr (std::same_as<Value, bool>) {
        return !value;
    } else {
        return false;
    }
}

/// A key, and the member that `access` gives: a pointer to it, or a function from the record.
template <typename Access>
class Field {
  public:
    constexpr Field(const char* key, Access access, Range range = Range::any, Absent absent = Absent::never)
        : key_(key), access_(access), range_(range), absent_(absent) {}
    constexpr Field(const char* key, Access access, Absent absent) : Field(key, access, Range::any, absent) {}

    template <typename Record>
    void read(const JsonNode& json, Record& record) const {
        auto& value = std::invoke(access_, record);
        if (!kIsOptional<std::remove_cvref_t<decltype(value)>> && absent_ == Absent::never) {
            read_value(json.member(key_), value, range_);
        } else if (const auto found = json.find(key_)) {
            read_value(*found, value, range_);
        }
    }

    template <typename Record>
    void put(nlohmann::ordered_json& json, const Record& record, const std::string& place) const {
        const auto& value = std::invoke(access_, record);
        if constexpr (kIsOptional<std::remove_cvref_t<decltype(value)>>) {
            if (value) json[key_] = value_json(*value, place + key_);
        } else if (absent_ != Absent::if_empty || !is_empty(value)) {
            json[key_] = value_json(value, place + key_);
        }
    }

  private:
    const char* key_;
    Access access_;
    Range range_;
    Absent absent_;
};

/// Gives the member of a member, as the `access` of a field.
template <auto outer, auto inner>
inline constexpr auto kInside =
    [](auto& record) -> decltype(auto) { return std::invoke(inner, std::invoke(outer, record)); };

/// The fields of a member among those of the record. A std::optional member is there if `key` is.
template <typename Access>
class Inlined {
  public:
    constexpr explicit Inlined(Access access, const char* key = "") : access_(access), key_(key) {}

    template <typename Record>
    void read(const JsonNode& json, Record& record) const {
        auto& value = std::invoke(access_, record);
        if constexpr (!kIsOptional<std::remove_cvref_t<decltype(value)>>) {
            read_fields(json, value, kFields<std::remove_cvref_t<decltype(value)>>);
        } else if (json.find(key_)) {
            read_fields(json, value.emplace(), kFields<std::remove_cvref_t<decltype(*value)>>);
        }
    }

    template <typename Record>
    void put(nlohmann::ordered_json& json, const Record& record, const std::string& place) const {
        const auto& value = std::invoke(access_, record);
        if constexpr (!kIsOptional<std::remove_cvref_t<decltype(value)>>) {
            put_fields(json, value, kFields<std::remove_cvref_t<decltype(value)>>, place);
        } else if (value) {
            put_fields(json, *value, kFields<std::remove_cvref_t<decltype(*value)>>, place);
        }
    }

  private:
    Access access_;
    const char* key_;
};

/// Each may be absent.
template <>
inline constexpr std::tuple kFields<ParameterTag>{Field{"parameters", &ParameterTag::name},
                                                  Field{"parameters_hash", &ParameterTag::hash},
                                                  Field{"pairing", &ParameterTag::pairing}};

/// Refuses a second record of a file with the same key.
template <typename Key>
class FirstLines {
  public:
    /// `twice`: what is wrong with a second one, up to "first on line N".
    void require_new(Key key, const JsonNode& json, const char* member, const std::string& twice) {
        const auto [first, is_new] = line_of_.try_emplace(std::move(key), json.line());
        if (!is_new) json.fail_in(member, twice + ", first on line " + std::to_string(first->second));
    }

  private:
    std::map<Key, std::size_t> line_of_;
};

/// The records of a file, one on a line; `check` may refuse one.
template <typename Record>
std::vector<Record> read_records(const std::filesystem::path& file,
                                 const std::function<void(const JsonNode&, const Record&)>& check = {}) {
    std::vector<Record> records;
    for_each_json_line(file, [&](const JsonNode& json) {
        Record& record = records.emplace_back();
        record.line = json.line();
        read_fields(json, record, kFields<Record>);
        if (check) check(json, record);
    });
    return records;
}

/// `name` is that of the list in errors.
template <typename Record>
void write_records(const std::filesystem::path& file, std::span<const Record> records,
                   const std::string& name) {
    AtomicFile output(file);
    for (std::size_t i = 0; i < records.size(); ++i)
        output.stream() << to_line(value_json(records[i], name + "[" + std::to_string(i) + "]")) << '\n';
    output.commit();
}

/// Calls `use` with each line of a stream that is not blank, before the next one is read. `read(json, line)`
/// fills the line; if it throws InputError, that is the line's `fault`.
template <typename Line, typename Read>
void for_each_stream_line(std::istream& stream, const Read& read,
                          const std::function<void(const Line&)>& use) {
    std::size_t number = 0;
    for (std::string text; std::getline(stream, text);) {
        ++number;
        if (is_blank(text)) continue;
        Line line;
        line.number = number;
        try {
            with_json_line(text, "", number, [&](const JsonNode& json) { read(json, line); });
        } catch (const InputError& error) {
            line.fault = error.what();
        }
        use(line);
    }
}

}  // namespace conelane
