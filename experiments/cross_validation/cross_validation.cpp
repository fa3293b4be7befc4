#include "experiments/cross_validation/cross_validation.hpp"

#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/track_spec.hpp"

#include <iterator>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

/// The family of each course by its name. Throws InputError if a course occurs twice.
std::map<std::string, std::string> family_of_courses(const CrossValidationOptions& options) {
    std::map<std::string, std::string> family_of;
    const auto add = [&](const std::vector<std::string>& specs, const std::string& family) {
        for (const std::string& spec : specs) {
            for (const Track& track : load_tracks(spec)) {
                const auto [first, is_new] = family_of.emplace(track.name, family);
                if (is_new) continue;
                throw InputError(
                    "", 0, "--family",
                    fmt::format("course '{}' is in '{}' and in '{}'", track.name, first->second, family));
            }
        }
    };
    add(options.always, "--always");
    for (const CourseFamily& family : options.families) add(family.tracks, family.name);
    return family_of;
}

LearningOptions without(const CrossValidationOptions& options, const CourseFamily& held_out) {
    LearningOptions learning = options.learning;
    learning.tracks = options.always;
    for (const CourseFamily& family : options.families) {
        if (family.name != held_out.name)
            std::ranges::copy(family.tracks, std::back_inserter(learning.tracks));
    }
    return learning;
}

/// The hash of each file in the folder of a family, sorted by name. Throws InputError.
nlohmann::ordered_json hashes_in(const fs::path& folder, const char* option) {
    std::error_code failure;
    std::map<std::string, std::string> hashes;
    for (const fs::directory_entry& file : fs::directory_iterator(folder, failure))
        hashes[file.path().filename()] = file_hash(file.path());
    if (failure) throw InputError(folder, 0, option, "cannot be read: " + failure.message());
    return hashes;
}

nlohmann::ordered_json hashes_of(const std::vector<CourseFamily>& families, const fs::path& folds,
                                 const char* option) {
    nlohmann::ordered_json hashes = nlohmann::ordered_json::object();
    for (const CourseFamily& family : families) hashes[family.name] = hashes_in(folds / family.name, option);
    return hashes;
}

/// Everything that the folds depend on, for the record of the comparison.
std::string record_of(const CrossValidationOptions& options) {
    nlohmann::ordered_json families = nlohmann::ordered_json::object();
    for (const CourseFamily& family : options.families) families[family.name] = family.tracks;
    if (!options.folds.empty()) {
        return nlohmann::ordered_json{{"families", families},
                                      {"folds", hashes_of(options.families, options.folds, "--folds")}}
            .dump();
    }
    const LearningOptions& learning = options.learning;
    nlohmann::ordered_json record{{"families", families},
                                  {"always", options.always},
                                  {"scenes", scene_options_json(learning.scenes)},
                                  {"variants", learning.variants},
                                  {"evaluations", learning.evaluations},
                                  {"front_steps", learning.front_steps},
                                  {"rld_steps", learning.rld_steps}};
    if (!options.colors_from.empty())
        record["colors_from"] = hashes_of(options.families, options.colors_from, "--colors-from");
    return record.dump();
}

void check(const CrossValidationOptions& options) {
    if (options.families.size() < 2) throw InvalidInput("family", "there must be at least two");
    std::set<std::string> names;
    for (const CourseFamily& family : options.families) {
        if (!names.insert(family.name).second)
            throw InvalidInput("family", fmt::format("'{}' is there twice", family.name));
    }
    if (options.colors_from.empty()) return;
    if (!options.learning.scenes.with_color) throw InvalidInput("colors-from", "needs scenes with colour");
    for (const Method& method : options.comparison.methods) {
        if (method.recipe != nullptr && method.recipe->color_use == ColorUse::ignored)
            throw InvalidInput("colors-from", fmt::format("'{}' ignores colours", method.name));
    }
}

/// --overwrite removes the folds of the directory, and learning writes there.
void require_elsewhere(const fs::path& input, const char* option, const fs::path& directory) {
    std::error_code ignored;
    const fs::path folds = fs::weakly_canonical(directory / "folds", ignored);
    const fs::path place = fs::weakly_canonical(input, ignored);
    if (!input.empty() && std::ranges::mismatch(folds, place).in1 == folds.end())
        throw InputError(input, 0, option, "is in the directory of the results, which would replace it");
}

}  // namespace

std::vector<CourseFamily> parse_families(const std::vector<std::string>& texts) {
    constexpr std::string_view kOfNames = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    std::vector<CourseFamily> families;
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        const std::string name = text.substr(0, equals);
        if (equals == std::string::npos || name.empty() ||
            name.find_first_not_of(kOfNames) != std::string::npos)
            throw InvalidInput("--family",
                               "'" + text + "' is not NAME=SPEC with a name of letters, digits, _ and -");
        auto family = std::ranges::find(families, name, &CourseFamily::name);
        if (family == families.end()) family = families.insert(families.end(), {name, {}});
        family->tracks.push_back(text.substr(equals + 1));
    }
    return families;
}

void require_held_out(const std::set<std::string>& courses, const fs::path& fold) {
    std::error_code unreadable;  // is said where the files are used
    for (const fs::directory_entry& entry : fs::directory_iterator(fold, unreadable)) {
        const fs::path& file = entry.path();
        if (file.extension() != ".json" || !entry.is_regular_file(unreadable)) continue;
        const auto json = nlohmann::json::parse(text_of(file), nullptr, false);
        if (!json.is_object() || !json.contains("training") || !json["training"].is_object()) continue;
        for (const char* key : {"tracks", "trust_tracks"}) {
            const nlohmann::json tracks = json["training"].value(key, nlohmann::json::array());
            for (const nlohmann::json& track : tracks) {
                if (!track.is_string() || !courses.contains(track.get<std::string>())) continue;
                throw InputError(file, 0, fmt::format("training.{}", key),
                                 fmt::format("has learned from '{}', which '{}' holds out",
                                             track.get<std::string>(), fold.filename().string()));
            }
        }
    }
}

ComparisonOutcome cross_validate(const CrossValidationOptions& options, const fs::path& directory) {
    check(options);
    require_elsewhere(options.folds, "--folds", directory);
    require_elsewhere(options.colors_from, "--colors-from", directory);
    const auto family_of =
        std::make_shared<const std::map<std::string, std::string>>(family_of_courses(options));
    ComparisonOptions comparison = options.comparison;
    comparison.tracks.clear();
    for (const CourseFamily& family : options.families)
        std::ranges::copy(family.tracks, std::back_inserter(comparison.tracks));
    comparison.cross_validation = record_of(options);

    for (const CourseFamily& family : options.families) {
        std::set<std::string> courses;
        for (const auto& [course, of] : *family_of) {
            if (of == family.name) courses.insert(course);
        }
        for (const fs::path* const learned : {&options.folds, &options.colors_from}) {
            if (!learned->empty()) require_held_out(courses, *learned / family.name);
        }
    }
    const bool learns = options.folds.empty();
    const fs::path folds = learns ? directory / "folds" : options.folds;
    comparison.prepare = [&] {
        if (!learns) return;
        for (const CourseFamily& family : options.families) {
            LearningOptions learning = without(options, family);
            if (!options.colors_from.empty()) learning.without_colors = options.colors_from / family.name;
            fs::create_directories(folds / family.name);
            for (const Method& method : options.comparison.methods) {
                if (method.learner != nullptr) method.learner->learn(learning, folds / family.name);
            }
        }
    };
    for (Method& method : comparison.methods) {
        if (method.learner == nullptr) continue;
        method.maker_of_folds = [learned = method, folds, family_of, &options](const RunOptions& run) {
            std::map<std::string, DetectorMaker> of_family;
            for (const CourseFamily& family : options.families)
                of_family.emplace(family.name, learned.learned_maker(folds / family.name, run));
            return [of_family = std::move(of_family), family_of](const std::string& track) {
                return of_family.at(family_of->at(track))(track);
            };
        };
    }
    return compare(comparison, directory);
}

}  // namespace conelane::experiments
