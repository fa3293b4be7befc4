#include "conelane/invalid_input.hpp"
#include "conelane/rld_parameter_sets.hpp"
#include "detectors/parameters/learned_costs_reader.hpp"
#include "model/position_covariance.hpp"
#include "python/bindings/bindings.hpp"

#include <tuple>

namespace conelane::python {
namespace {

constexpr std::array kColors{ConeColor::unknown, ConeColor::blue, ConeColor::yellow, ConeColor::orange,
                             ConeColor::big_orange};

std::string shape_of(const py::array& array) {
    return py::str(py::handle(array.attr("shape")));
}

py::array any_array(py::handle object, const char* key) {
    py::array array = py::array::ensure(object);
    if (!array) throw InvalidInput(key, "is not an array");
    return array;
}

[[noreturn]] void refuse_dtype(const py::array& array, const char* key, const std::string& wanted) {
    throw InvalidInput(key, "has dtype " + std::string(py::str(array.dtype())) + ", not " + wanted);
}

bool is_one_of(char kind, std::string_view kinds) {
    return kinds.find(kind) != std::string_view::npos;
}

void require_length(const py::array& array, std::size_t count, const char* key) {
    if (array.ndim() == 1 && static_cast<std::size_t>(array.size()) == count) return;
    throw InvalidInput(key,
                       "has shape " + shape_of(array) + ", not (" + std::to_string(count) + ",) as cones");
}

py::array_t<std::int64_t, py::array::c_style | py::array::forcecast> whole_numbers(const py::array& array,
                                                                                   const char* key) {
    const char kind = array.dtype().kind();
    if (array.size() > 0 && !is_one_of(kind, "iu")) refuse_dtype(array, key, "whole numbers");
    py::array_t<std::int64_t, py::array::c_style | py::array::forcecast> values(array);
    if (kind != 'u') return values;
    for (py::ssize_t i = 0; i < values.size(); ++i) {
        if (values.data()[i] < 0) {
            throw InvalidInput(std::string(key) + "[" + std::to_string(i) + "]", "is above 2^63 - 1");
        }
    }
    return values;
}

std::string color_names() {
    std::string names;
    for (const ConeColor color : kColors)
        names += (names.empty() ? "" : ", ") + std::string(to_string(color));
    return names;
}

ConeColor color_of(std::int64_t code, const std::string& key) {
    if (code < 0 || code >= static_cast<std::int64_t>(kColors.size())) {
        throw InvalidInput(key,
                           std::to_string(code) + " is not a colour; colours are 0 to 4: " + color_names());
    }
    return kColors[static_cast<std::size_t>(code)];
}

ConeColor color_of(const std::string& name, const std::string& key) {
    const auto* const color =
        std::ranges::find_if(kColors, [&](ConeColor c) { return to_string(c) == name; });
    if (color == kColors.end())
        throw InvalidInput(key, "'" + name + "' is not a colour; colours are " + color_names());
    return *color;
}

/// Rows of probabilities, and the most probable labels.
void set_color_probabilities(std::vector<Cone>& cones, const Numbers& given) {
    constexpr py::ssize_t kClasses = 5;
    if (given.shape(0) != static_cast<py::ssize_t>(cones.size()) || given.shape(1) != kClasses)
        throw InvalidInput("colors", "has shape " + shape_of(given) + ", not (" +
                                         std::to_string(cones.size()) + ", 5) or (" +
                                         std::to_string(cones.size()) + ",)");
    const double* row = given.data();
    for (Cone& cone : cones) {
        cone.color_probabilities = ColorProbabilities{row[0], row[1], row[2], row[3], row[4]};
        cone.color = most_probable_color(*cone.color_probabilities);
        row += kClasses;
    }
}

void set_colors(std::vector<Cone>& cones, py::handle object) {
    const py::array given = any_array(object, "colors");
    if (given.ndim() == 2) {
        set_color_probabilities(cones, numbers(object, "colors"));
        return;
    }
    require_length(given, cones.size(), "colors");
    if (cones.empty()) return;
    const auto key = [](std::size_t i) { return "colors[" + std::to_string(i) + "]"; };
    if (given.dtype().kind() == 'U') {
        std::size_t i = 0;
        for (const py::handle name : given) {
            cones[i].color = color_of(py::str(name), key(i));
            ++i;
        }
        return;
    }
    if (!is_one_of(given.dtype().kind(), "iu")) refuse_dtype(given, "colors", "names or codes of colours");
    const auto codes = whole_numbers(given, "colors");
    for (std::size_t i = 0; i < cones.size(); ++i) cones[i].color = color_of(codes.data()[i], key(i));
}

void set_covariances(std::vector<Cone>& cones, const Numbers& given) {
    constexpr py::ssize_t kSize = 2;
    const bool fits = cones.empty()
                          ? given.size() == 0
                          : given.ndim() == 3 && given.shape(0) == static_cast<py::ssize_t>(cones.size()) &&
                                given.shape(1) == kSize && given.shape(2) == kSize;
    if (!fits)
        throw InvalidInput("covariances", "has shape " + shape_of(given) + ", not (" +
                                              std::to_string(cones.size()) + ", 2, 2)");
    const double* matrix = given.data();
    for (std::size_t i = 0; i < cones.size(); ++i, matrix += kSize * kSize) {
        const std::string key = "covariances[" + std::to_string(i) + "]";
        if (!std::all_of(matrix, matrix + kSize * kSize, [](double value) { return std::isfinite(value); }))
            throw InvalidInput(key, "must be a finite number");
        cones[i].position_covariance = covariance_of({matrix[0], matrix[1], matrix[2], matrix[3]});
        if (!cones[i].position_covariance) throw InvalidInput(key, "must be symmetric");
        if (!cones[i].position_covariance->is_valid())
            throw InvalidInput(key, "must be positive semidefinite");
    }
}

/// Known keys, for the message about an unknown one.
std::string parameter_keys() {
    std::string keys;
    for (const auto fields : {rld_parameter_fields(), rld_extra_fields()}) {
        for (const RldParameterField& field : fields) keys += std::string(field.key) + ", ";
    }
    return keys + "pairing, use_confidence, forbid_crossing, learned_costs";
}

void set_parameter(RldParameters& parameters, const std::string& key, py::handle value) {
    for (const auto fields : {rld_parameter_fields(), rld_extra_fields()}) {
        const auto field = std::ranges::find(fields, key, &RldParameterField::key);
        if (field == fields.end()) continue;
        parameters.*field->value = number(value, key);
        return;
    }
    if (key == "pairing") {
        parameters.pairing = pairing_of(std::string(py::str(value)));
    } else if (key == "use_confidence" || key == "forbid_crossing") {
        if (!py::isinstance<py::bool_>(value)) throw InvalidInput(key, "is neither True nor False");
        (key == "use_confidence" ? parameters.use_confidence : parameters.forbid_crossing) =
            value.cast<bool>();
    } else if (key == "learned_costs") {
        if (py::isinstance<LearnedCosts>(value))
            parameters.learned_costs = value.cast<std::shared_ptr<LearnedCosts>>();
        else
            parameters.learned_costs = read_learned_costs(std::string(py::str(value)));
    } else {
        throw InvalidInput("parameters", "there is no '" + key + "', only " + parameter_keys());
    }
}

template <typename Value, typename Of>
py::array_t<Value> column(std::span<const Cone> cones, const Of& of) {
    py::array_t<Value> values(static_cast<py::ssize_t>(cones.size()));
    std::ranges::transform(cones, values.mutable_data(), of);
    return values;
}

/// A row of numbers of each item.
template <typename Item, typename Of>
py::array_t<double> rows(std::span<const Item> items, const Of& of) {
    constexpr std::size_t kWidth = std::tuple_size_v<std::invoke_result_t<Of, const Item&>>;
    py::array_t<double> result({items.size(), kWidth});
    double* out = result.mutable_data();
    for (const Item& item : items) out = std::ranges::copy(of(item), out).out;
    return result;
}

}  // namespace

Numbers numbers(py::handle object, const char* key) {
    const py::array array = any_array(object, key);
    if (array.size() > 0 && !is_one_of(array.dtype().kind(), "fiu")) refuse_dtype(array, key, "real numbers");
    return Numbers(array);
}

double number(py::handle object, const std::string& key) {
    const double value = PyFloat_AsDouble(object.ptr());
    if (py::isinstance<py::bool_>(object) || (value == -1.0 && PyErr_Occurred() != nullptr)) {
        PyErr_Clear();
        throw InvalidInput(key, "is not a number");
    }
    return value;
}

std::vector<Point> points(py::handle object, const char* key) {
    const Numbers array = numbers(object, key);
    if (array.size() == 0) return {};
    if (array.ndim() != 2 || array.shape(1) != 2)
        throw InvalidInput(key, "has shape " + shape_of(array) + ", not (N, 2)");
    std::vector<Point> points;
    points.reserve(static_cast<std::size_t>(array.shape(0)));
    const double* const data = array.data();
    for (py::ssize_t i = 0; i < array.shape(0); ++i) points.emplace_back(data[2 * i], data[2 * i + 1]);
    return points;
}

Pose pose(py::handle object) {
    const Numbers array = numbers(object, "pose");
    if (array.ndim() != 1 || array.size() != 3)
        throw InvalidInput("pose", "has shape " + shape_of(array) + ", not (3,): x, y, yaw");
    return {{array.data()[0], array.data()[1]}, array.data()[2]};
}

std::vector<Cone> cones(py::handle positions, py::handle ids, py::handle colors, py::handle confidences,
                        py::handle covariances) {
    const std::vector<Point> at = points(positions, "cones");
    std::vector<Cone> cones(at.size());
    for (std::size_t i = 0; i < at.size(); ++i) {
        cones[i].id = static_cast<ConeId>(i);
        cones[i].position = at[i];
    }
    if (!ids.is_none()) {
        const py::array given = any_array(ids, "ids");
        require_length(given, at.size(), "ids");
        const auto values = whole_numbers(given, "ids");
        for (std::size_t i = 0; i < at.size(); ++i) cones[i].id = values.data()[i];
    }
    if (!colors.is_none()) set_colors(cones, colors);
    if (!confidences.is_none()) {
        const Numbers values = numbers(confidences, "confidences");
        require_length(values, at.size(), "confidences");
        for (std::size_t i = 0; i < at.size(); ++i) cones[i].confidence = values.data()[i];
    }
    if (!covariances.is_none()) set_covariances(cones, numbers(covariances, "covariances"));
    return cones;
}

std::vector<ConeId> ids_at(py::handle indices, std::span<const Cone> cones, const char* key) {
    const py::array given = any_array(indices, key);
    if (given.ndim() != 1) throw InvalidInput(key, "has shape " + shape_of(given) + ", not (N,)");
    const auto values = whole_numbers(given, key);
    std::vector<ConeId> ids;
    for (py::ssize_t i = 0; i < values.size(); ++i) {
        const std::int64_t index = values.data()[i];
        if (index < 0 || index >= static_cast<std::int64_t>(cones.size())) {
            throw InvalidInput(
                std::string(key) + "[" + std::to_string(i) + "]",
                std::to_string(index) + " is not an index of the " + std::to_string(cones.size()) + " cones");
        }
        ids.push_back(cones[static_cast<std::size_t>(index)].id);
    }
    return ids;
}

std::size_t positive_count(py::handle object, const char* key) {
    const bool is_whole = PyIndex_Check(object.ptr()) != 0 && !py::isinstance<py::bool_>(object);
    const py::ssize_t count = is_whole ? PyNumber_AsSsize_t(object.ptr(), nullptr) : 0;
    if (count < 1) throw InvalidInput(key, "must be a whole number, at least 1");
    return static_cast<std::size_t>(count);
}

std::optional<RldParameters> rld_parameters(py::handle object) {
    if (object.is_none()) return std::nullopt;
    if (py::isinstance<py::str>(object)) {
        const std::string name = py::str(object);
        if (name == "default") return RldParameters{};
        if (auto set = rld_parameter_set(name)) return set;
        std::string names = "default";
        for (const std::string_view known : rld_parameter_set_names()) names += ", " + std::string(known);
        throw InvalidInput("parameters", "there is no set '" + name + "', only " + names);
    }
    if (!py::isinstance<py::dict>(object))
        throw InvalidInput("parameters", "is neither None, the name of a set nor a dict");
    RldParameters parameters;
    for (const auto& [key, value] : py::reinterpret_borrow<py::dict>(object))
        set_parameter(parameters, py::str(key), value);
    validate(parameters);
    return parameters;
}

Pairing pairing_of(std::string_view name) {
    for (const Pairing pairing : {Pairing::near_far, Pairing::paper}) {
        if (to_string(pairing) == name) return pairing;
    }
    throw InvalidInput("pairing", "'" + std::string(name) + "' is not one of near_far, paper");
}

py::array_t<double> array(std::span<const Point> points) {
    return rows(points, [](const Point& point) { return std::array{point.x(), point.y()}; });
}

py::array_t<double> array(const Pose& pose) {
    const std::array values{pose.position.x(), pose.position.y(), pose.yaw_rad};
    return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

py::array_t<double> array(const DrivableLane& lane) {
    return rows(std::span<const DrivablePoint>(lane.points), [](const DrivablePoint& point) {
        return std::array{point.s_m,           point.position.x(), point.position.y(), point.heading_rad,
                          point.curvature_1pm, point.width_left_m, point.width_right_m};
    });
}

Indices array(std::span<const std::int64_t> values) {
    return Indices(static_cast<py::ssize_t>(values.size()), values.data());
}

py::array_t<double> positions(std::span<const Cone> cones) {
    return rows(cones, [](const Cone& cone) { return std::array{cone.position.x(), cone.position.y()}; });
}

Indices ids(std::span<const Cone> cones) {
    return column<std::int64_t>(cones, [](const Cone& cone) { return cone.id; });
}

py::array_t<std::uint8_t> colors(std::span<const Cone> cones) {
    return column<std::uint8_t>(cones, [](const Cone& cone) {
        return static_cast<std::uint8_t>(std::ranges::find(kColors, cone.color) - kColors.begin());
    });
}

py::array_t<double> color_probabilities(std::span<const Cone> cones) {
    return rows(cones, [](const Cone& cone) {
        const ColorProbabilities p = cone.probabilities();
        return std::array{p.unknown, p.blue, p.yellow, p.orange, p.big_orange};
    });
}

py::array_t<double> confidences(std::span<const Cone> cones) {
    return column<double>(cones, [](const Cone& cone) { return cone.confidence; });
}

std::optional<py::array_t<double>> covariances(std::span<const Cone> cones) {
    if (std::ranges::none_of(cones, [](const Cone& cone) { return cone.position_covariance.has_value(); }))
        return std::nullopt;
    return rows(cones,
                [](const Cone& cone) {
                    const PositionCovariance c = cone.position_covariance.value_or(PositionCovariance{});
                    return std::array{c.xx_m2, c.xy_m2, c.xy_m2, c.yy_m2};
                })
        .reshape({static_cast<py::ssize_t>(cones.size()), py::ssize_t{2}, py::ssize_t{2}});
}

std::vector<std::int64_t> indices_of(std::span<const ConeId> ids, std::span<const Cone> cones,
                                     std::string_view key) {
    std::vector<std::int64_t> indices;
    indices.reserve(ids.size());
    std::unordered_map<ConeId, std::int64_t> index_of;  // for look-up only; used if ids are not indices
    for (const ConeId id : ids) {
        if (id >= 0 && id < static_cast<ConeId>(cones.size()) &&
            cones[static_cast<std::size_t>(id)].id == id) {
            indices.push_back(id);
            continue;
        }
        if (index_of.empty()) {
            for (std::size_t i = 0; i < cones.size(); ++i)
                index_of.emplace(cones[i].id, static_cast<std::int64_t>(i));
        }
        const auto found = index_of.find(id);
        if (found == index_of.end()) {
            throw InvalidInput(std::string(key) + "[" + std::to_string(indices.size()) + "]",
                               "cone id " + std::to_string(id) + " is not in the scene");
        }
        indices.push_back(found->second);
    }
    return indices;
}

}  // namespace conelane::python
