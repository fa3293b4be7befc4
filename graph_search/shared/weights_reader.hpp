#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {

class JsonReader;

/// A file of weights: a JSON object with `version`, `training`, which says where they come from, names of
/// inputs, and lists of numbers. A value is found by its path, such as `mean`, `hidden[2]` or
/// `measures.width_m.scores`. All functions throw InvalidInput naming the key that is wrong.
class WeightsReader {
  public:
    /// Reads all of it. `what`: the key of errors in lines that are not JSON. `command`: what writes such
    /// files.
    WeightsReader(std::string_view text, std::string_view what, std::string_view command);

    [[nodiscard]] int version(std::initializer_list<int> known);
    /// The text of `training`.
    [[nodiscard]] std::string_view training();
    [[nodiscard]] double number(const std::string& path);
    [[nodiscard]] const std::vector<double>& numbers(const std::string& path);
    /// A list of this many numbers, each in the range of float.
    [[nodiscard]] std::vector<float> floats(const std::string& path, std::size_t count);
    /// Number of elements of a list.
    [[nodiscard]] std::size_t size(const std::string& path) { return find(path).size; }
    /// The names of a list have to be the first ones of these. Returns their number.
    [[nodiscard]] std::size_t first_names(const std::string& path, std::span<const std::string_view> known);
    /// They have to be the names of these features, in their order.
    template <typename Features>
    void require_features(const std::string& path, const Features& features) {
        std::vector<std::string_view> known;
        for (const auto& feature : features) known.push_back(feature.name);
        require_names(path, known);
    }
    /// Throws if there is a key that was not asked for. `of`: "weights of front".
    void require_no_other(std::string_view of) const;

  private:
    struct Value {
        bool is_list = false;
        std::size_t size = 0;  ///< of a list
        std::vector<double> numbers;
        std::vector<std::string> names;
        std::size_t first_other = 0;  ///< place of the first element that is no number, or the size
        bool is_used = false;
    };
    void read(JsonReader& json, const std::string& path);
    void read_element(JsonReader& json, const std::string& path, Value& list);
    const Value& find(const std::string& path);
    void require_names(const std::string& path, std::span<const std::string_view> known);

    std::map<std::string, Value, std::less<>> values_;
    std::string_view text_;
    std::string_view training_;
};

/// Calls `parse` with the content of a file of at most 64 MB. InvalidInput of reading or parsing names the
/// file too.
void with_weights_file(const std::filesystem::path& file, const std::function<void(std::string_view)>& parse);

}  // namespace conelane
