#include "experiments/report/report.hpp"
#include "program/commands/command_parts.hpp"

#include <fmt/ranges.h>

// What the Python package of the program draws: pages and pictures.
namespace conelane::program {
namespace {

struct ReportOptions {
    std::string results;
    std::string page;
    std::string pictures;
    std::string python;
    std::vector<std::string> viewer;
};

void make_report(const ReportOptions& options) {
    call_package([&] {
        write_report(options.results, options.page, options.pictures, options.python,
                     fmt::format("{}", fmt::join(options.viewer, ",")));
    });
    fmt::print("the page is {}\n", options.page);
}

struct PlotOptions {
    std::string scenes;
    std::vector<std::string> lanes;
    std::string id;
    std::string out;
    std::vector<std::string> detectors;
    bool with_given = false;
    bool without_truth = false;
    std::string title;
    std::string python;
};

/// The boundaries of the scene's track, if a companion of the scenes file has them.
TrackBoundariesByName track_of(const PlotOptions& options, const std::string& track) {
    const std::filesystem::path companion = track_boundaries_path(options.scenes);
    if (track.empty() || !std::filesystem::exists(companion)) return {};
    TrackBoundariesByName tracks = read_track_boundaries(companion);
    std::erase_if(tracks, [&](const auto& named) { return named.first != track; });
    return tracks;
}

/// The lanes of the scene in one file, in its order.
void add_lanes(const std::string& file, const PlotOptions& options, Picture& picture) {
    const std::size_t before = picture.lanes.size();
    for (LaneRecord& record : read_lanes(file)) {
        if (record.scene != options.id) continue;
        if (!options.detectors.empty() &&
            std::ranges::find(options.detectors, record.detector) == options.detectors.end())
            continue;
        PicturedLane lane{std::move(record), {}};
        try {
            lane.drivable = drivable(lane.record.answer, picture.scene.scene);
        } catch (const InvalidInput& error) {
            throw InputError(file, lane.record.line, error.key(), reason_of(error));
        }
        picture.lanes.push_back(std::move(lane));
    }
    if (options.detectors.empty() && picture.lanes.size() == before)
        throw InputError(file, 0, "--id", "'" + options.id + "' is not a scene of it");
}

void plot(const PlotOptions& options) {
    Picture picture;
    picture.scene = scene_named(options.id, options.scenes);
    picture.tracks = track_of(options, picture.scene.track);
    picture.with_given = options.with_given;
    picture.with_truth = !options.without_truth;
    picture.title = options.title;
    for (const std::string& file : options.lanes) add_lanes(file, options, picture);
    for (const std::string& detector : options.detectors) {
        const auto is_of = [&](const PicturedLane& lane) { return lane.record.detector == detector; };
        if (std::ranges::none_of(picture.lanes, is_of)) {
            throw InputError(options.lanes.front(), 0, "--method",
                             "'" + detector + "' answers scene '" + options.id + "' in no file of --lanes");
        }
    }
    call_package([&] { write_picture(picture, options.out, options.python); });
    fmt::print("{}: scene {}, {} lanes\n", options.out, options.id, picture.lanes.size());
}

}  // namespace

void add_report_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("report", "one HTML page from stored results");
    auto options = std::make_shared<ReportOptions>();
    command.add_option("--results", options->results, "directory that `conelane compare` wrote")->required();
    add_output_option(command, "--out", options->page, "PAGE.html")->required();
    command.add_option("--png", options->pictures, "folder for the main figures as PNG too");
    command.add_option("--python", options->python, "interpreter that has matplotlib; python3 without it");
    command
        .add_option("--viewer", options->viewer,
                    "tracks whose laps the scene viewer has; without it as many laps as fit, first those on "
                    "which the methods fail most")
        ->delimiter(',');
    command.callback([options] { make_report(*options); });
}

void add_plot_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("plot", "a scene and its lanes as a picture, drawn as in the page's viewer");
    auto options = std::make_shared<PlotOptions>();
    command
        .add_option("--scenes", options->scenes,
                    "*.scenes.jsonl; with its companion *.tracks.json false cones are drawn as such")
        ->required();
    command.add_option("--lanes", options->lanes,
                       "*.lanes.jsonl, the lanes to draw; without it only the scene");
    command.add_option("--id", options->id, "id of the scene")->required();
    add_output_option(command, "--out", options->out, "X.svg or X.png")
        ->required()
        ->check(CLI::Validator(
            [](const std::string& file) {
                return file.ends_with(".svg") || file.ends_with(".png") ? ""
                                                                        : "must end in .svg or .png: " + file;
            },
            ""));
    command.add_option("--method", options->detectors, "only lanes of these methods")
        ->delimiter(',')
        ->needs("--lanes");
    command.add_flag("--given", options->with_given, "also draw what a detector gets: only cones and pose");
    command.add_flag("--no-truth", options->without_truth, "without the band of the ground truth");
    command.add_option("--title", options->title, "title above the lanes; the scene's id without it");
    command.add_option("--python", options->python, "interpreter that has matplotlib; python3 without it");
    command.callback([options] { plot(*options); });
}

}  // namespace conelane::program
