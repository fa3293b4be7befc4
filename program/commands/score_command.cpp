#include "evaluation/outside/point_snapping.hpp"
#include "experiments/comparison/results.hpp"
#include "program/commands/command_parts.hpp"

namespace conelane::program {
namespace {

struct ScoreOptions {
    std::string scenes;
    std::vector<std::string> lanes;
    std::vector<std::string> detectors;
    std::string json;
    bool wide = false;
};

/// Answers of a method in a lanes file.
struct Answers {
    MethodRecord method;
    std::string file;
    std::vector<LaneRecord> records;
};

auto find_answers(std::vector<Answers>& all, const MethodRecord& method) {
    return std::ranges::find_if(all, [&](const Answers& answers) {
        return answers.method.name == method.name && answers.method.nearest == method.nearest;
    });
}

/// A method of one name and cone-set size may be in one file only.
void add_answers(Answers added, std::vector<Answers>& all) {
    if (const auto known = find_answers(all, added.method); known != all.end()) {
        throw InputError(added.file, added.records.front().line, "method",
                         "lanes of '" + added.method.name + "' are in " + known->file + " too");
    }
    all.push_back(std::move(added));
}

/// The answers of a lanes file by their methods.
std::vector<Answers> answers_in(const std::string& file, std::span<const AnnotatedScene> scenes) {
    std::unordered_map<std::string, const Scene*> scene_of;
    for (const AnnotatedScene& annotated : scenes) scene_of.emplace(annotated.scene.id, &annotated.scene);
    std::vector<Answers> of_file;
    for (LaneRecord& record : read_lanes(file)) {
        if (const auto scene = scene_of.find(record.scene); scene != scene_of.end())
            snap_to_cones(record, *scene->second);
        MethodRecord method{.name = record.detector, .nearest = record.nearest};
        auto known = find_answers(of_file, method);
        if (known == of_file.end()) {
            method.training_courses = training_courses(method.name);
            known = of_file.insert(known, {std::move(method), file, {}});
        }
        known->records.push_back(std::move(record));
    }
    if (of_file.empty()) throw InputError(file, 0, "", "holds no lane");
    return of_file;
}

std::vector<Answers> read_all(const ScoreOptions& options, std::span<const AnnotatedScene> scenes) {
    if (options.lanes.empty() && options.detectors.empty())
        throw InvalidInput("--lanes", "is required, or --methods lanes:NAME=FILE");
    std::vector<Answers> all;
    for (const std::string& file : options.lanes) {
        for (Answers& answers : answers_in(file, scenes)) add_answers(std::move(answers), all);
    }
    for (const std::string& text : split_detectors(options.detectors)) {
        if (!text.starts_with("lanes:"))
            throw InvalidInput("--methods", "'" + text + "' is not of the form lanes:NAME=FILE");
        const Method method = parse_method(text);
        add_answers({record_of(method), method.outside->source, read_finished_lanes(*method.outside, scenes)},
                    all);
    }
    return all;
}

void score_all(const ScoreOptions& options) {
    const std::vector<AnnotatedScene> scenes = read_scenes(options.scenes);
    const std::filesystem::path companion = track_boundaries_path(options.scenes);
    TrackBoundariesByName tracks;
    LeftOutScenes left_out;
    if (std::filesystem::exists(companion)) {
        tracks = read_track_boundaries(companion);
        left_out = read_left_out(companion);
    }
    const RecordScorer scorer(scenes, tracks);
    std::vector<ScoredMethod> scored;
    for (Answers& answers : read_all(options, scenes)) {
        scored.push_back(scorer.score(std::move(answers.method), std::move(answers.records), answers.file));
    }
    if (!options.json.empty()) {
        nlohmann::ordered_json run{{"scenes", options.scenes}, {"lanes", options.lanes}};
        if (!options.detectors.empty()) run["lanes_of_methods"] = options.detectors;
        AtomicFile output(options.json);
        write_results(output.stream(), scored, run.dump());
        output.commit();
    }
    if (options.wide) {
        fmt::print("{}{}", wide_table(scored), table_note_on(left_out));
    } else {
        fmt::print("{}all measures: conelane score --wide\n", summary(scored, left_out));
    }
    if (tracks.empty()) fmt::print(stderr, "no {}: divergence is unknown\n", companion.string());
}

}  // namespace

void add_score_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "score", "usable lanes, latency and failures of methods; every measure of both papers");
    auto options = std::make_shared<ScoreOptions>();
    command.add_option("--scenes", options->scenes, "*.scenes.jsonl; *.tracks.json beside it")->required();
    command.add_option("--lanes", options->lanes, "*.lanes.jsonl, one or more");
    command.add_option("--methods", options->detectors,
                       "lanes:NAME=FILE: answers of another program, scored under that name "
                       "(docs/from-outside.md)");
    command.add_flag("--wide", options->wide,
                     "the table of every measure, with the papers' figures below; some 270 columns");
    add_output_option(command, "--json", options->json, "write the rows as JSON lines too");
    command.callback([options] { score_all(*options); });
}

}  // namespace conelane::program
