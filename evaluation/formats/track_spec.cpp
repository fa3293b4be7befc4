#include "evaluation/formats/track_spec.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/track_readers.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/world/generated_tracks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>

#include <fmt/core.h>

namespace conelane {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& spec, const std::string& reason) {
    throw InputError({}, 0, spec, reason);
}

template <typename Number>
std::optional<Number> parsed(std::string_view text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

std::vector<std::string_view> comma_separated(std::string_view text) {
    std::vector<std::string_view> items;
    while (true) {
        const std::size_t comma = text.find(',');
        items.push_back(text.substr(0, comma));
        if (comma == std::string_view::npos) return items;
        text.remove_prefix(comma + 1);
    }
}

std::vector<Track> generated(const std::string& spec, const std::string& names) {
    std::vector<Track> tracks;
    std::set<std::string> loaded;
    for (const std::string_view item : comma_separated(names)) {
        const std::size_t at = item.find('@');
        std::uint64_t seed = 0;
        if (at != std::string_view::npos) {
            const auto given = parsed<std::uint64_t>(item.substr(at + 1));
            if (!given) fail(spec, fmt::format("'{}' has no seed after @", item));
            seed = *given;
        }
        try {
            tracks.push_back(generate_track(std::string(item.substr(0, at)), seed));
        } catch (const InvalidInput& error) {
            fail(spec, error.what());
        }
        if (!loaded.insert(tracks.back().name).second) {
            fail(spec, fmt::format("{} is there twice", tracks.back().name));
        }
    }
    return tracks;
}

/// All N of `cone_map_N.yaml` and of `boundaries_N.yaml`, so that a file without its partner is noticed.
std::set<int> fsd_numbers(const fs::path& directory) {
    std::set<int> numbers;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory)) {
        const std::string name = entry.path().filename().string();
        for (const std::string_view prefix : {"cone_map_", "boundaries_"}) {
            constexpr std::string_view kSuffix = ".yaml";
            if (!name.starts_with(prefix) || !name.ends_with(kSuffix) ||
                name.size() < prefix.size() + kSuffix.size()) {
                continue;
            }
            const auto number = parsed<int>(
                std::string_view(name).substr(prefix.size(), name.size() - prefix.size() - kSuffix.size()));
            if (number) numbers.insert(*number);
        }
    }
    return numbers;
}

std::vector<Track> fsd(const std::string& spec, const std::string& where) {
    fs::path directory = where;
    std::set<int> numbers;
    const std::size_t colon = where.rfind(':');
    if (!fs::exists(directory) && colon != std::string::npos) {
        directory = where.substr(0, colon);
        for (const std::string_view item : comma_separated(std::string_view(where).substr(colon + 1))) {
            const auto number = parsed<int>(item);
            if (!number) fail(spec, fmt::format("'{}' is not the number of a track", item));
            if (!numbers.insert(*number).second) fail(spec, fmt::format("{} is there twice", *number));
        }
    }
    if (!fs::is_directory(directory)) fail(spec, directory.string() + " is not a directory");
    if (numbers.empty()) numbers = fsd_numbers(directory);
    if (numbers.empty()) fail(spec, directory.string() + " holds no cone_map_N.yaml");
    std::vector<Track> tracks;
    tracks.reserve(numbers.size());
    for (const int number : numbers) tracks.push_back(read_fsd_track(directory, number));
    return tracks;
}

/// The track of a file, or of all files in a folder with the format's ending, sorted by name.
std::vector<Track> of_files(const std::string& spec, const fs::path& where, const TrackFormat& format) {
    if (!fs::is_directory(where)) return {format.read(where)};
    std::set<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(where)) {
        if (entry.path().string().ends_with(format.ending)) files.insert(entry.path());
    }
    if (files.empty()) fail(spec, fmt::format("{} holds no {} file", where.string(), format.ending));
    std::vector<Track> tracks;
    for (const fs::path& file : files) tracks.push_back(format.read(file));
    return tracks;
}

constexpr TrackFormat kGeneratedTracks{
    .word = "generated",
    .what = "NAME[@SEED][,...]",
    .reads = "courses by their names, the seed is 0 unless given; a wrong name lists them",
    .load = generated};
constexpr TrackFormat kFsdTracks{.word = "fsd",
                                 .what = "DIR[:1,2]",
                                 .reads = "FSD racetrack data set: all of a folder, or these numbers",
                                 .load = fsd};

/// "A, B and C" of what `text` says of each source.
std::string listed(std::string_view last, const std::function<std::string(const TrackFormat&)>& text) {
    std::string list;
    for (const TrackFormat* format : track_formats()) {
        if (!list.empty()) list += format == track_formats().back() ? last : ", ";
        list += text(*format);
    }
    return list;
}

}  // namespace

std::span<const TrackFormat* const> track_formats() {
    static constexpr std::array kAll{&kGeneratedTracks, &kFsdTracks, &kPacsimTracks,
                                     &kEufsTracks,      &kRunTracks, &kDrivenRuns};
    return kAll;
}

std::string track_grammar() {
    return listed(" or ", [](const TrackFormat& one) { return fmt::format("{}:{}", one.word, one.what); });
}

std::string track_format_lines() {
    std::string lines = "Tracks (a folder in place of a FILE: all its files of that type, by name):\n";
    for (const TrackFormat* one : track_formats())
        lines += fmt::format("  {:<29} {}\n", fmt::format("{}:{}", one->word, one->what), one->reads);
    return lines;
}

std::vector<Track> load_tracks(const std::string& spec) {
    const std::size_t colon = spec.find(':');
    const std::string word = spec.substr(0, colon);
    const std::string what = colon == std::string::npos ? "" : spec.substr(colon + 1);
    if (what.empty()) {
        fail(spec,
             fmt::format("is not {}, and instead of a FILE, a folder with such files", track_grammar()));
    }
    const auto format = std::ranges::find(track_formats(), word, &TrackFormat::word);
    if (format == track_formats().end()) {
        const auto words = [](const TrackFormat& one) { return std::string(one.word); };
        fail(spec, fmt::format("'{}' is not one of {}", word, listed(" and ", words)));
    }
    try {
        return (*format)->load ? (*format)->load(spec, what) : of_files(spec, what, **format);
    } catch (const fs::filesystem_error& error) {
        fail(spec, error.code().message());
    }
}

std::vector<Track> load_tracks_aloud(const std::string& spec) {
    std::vector<Track> tracks = load_tracks(spec);
    for (const Track& track : tracks) {
        for (const std::string& warning : track.warnings) {
            fmt::print(stderr, "conelane: {}: {}\n", track.name, warning);
        }
    }
    return tracks;
}

}  // namespace conelane
