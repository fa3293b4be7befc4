#include "experiments/studies/solve_rows.hpp"

#include "conelane/check.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/progress/progress.hpp"
#include "evaluation/seeded_random.hpp"
#include "experiments/comparison/runner.hpp"
#include "experiments/studies/machine.hpp"

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

/// The seed of a permutation, of a scene; never 0.
std::uint64_t permutation_seed(const std::string& scene, std::size_t permutation, std::uint64_t seed) {
    boost::random::mt19937_64 random = generator_of("permutation of " + scene, seed + 1000 * permutation);
    return random() | 1U;
}

Scene with_shuffled_cones(Scene scene, std::uint64_t seed) {
    boost::random::mt19937_64 random = generator_of("cones", seed);
    shuffle(scene.cones, random);
    return scene;
}

/// A backend along a lap.
class Driver {
  public:
    Driver(const Backend& backend, std::size_t size, const SolveOptions& options)
        : backend_(backend), size_(size), options_(options), solver_(backend) {}

    void forget() { previous_.reset(); }
    [[nodiscard]] bool is_warm() const { return is_warm_; }  ///< something was solved
    [[nodiscard]] BackendSolver& solver() { return solver_; }

    /// The stored row, or else a solve under each limit until one is enough. From nothing, or from the scene
    /// before; permutations above 0 are other orders of cones, rows and columns, from nothing.
    SolveRow solve(const AnnotatedScene& annotated, const Scene& cones, std::size_t permutation) {
        SolveRow row{.scene = &annotated,
                     .size = size_,
                     .cones = cones.cones.size(),
                     .permutation = permutation,
                     .scene_hash = text_hash(scene_line(cones)),
                     .backend = backend_,
                     .limit_ms = options_.longest_limit_ms()};
        if (options_.stored != nullptr) {
            if (auto stored = options_.stored->find(row)) return *std::move(stored);
        }
        if (!std::exchange(is_warm_, true)) {  // code is loaded before times are taken
            (void)solve_within(annotated, cones, options_.time_limit_ms);
            previous_.reset();
        }
        std::vector<double> limits_ms = options_.then_ms;
        limits_ms.insert(limits_ms.begin(), options_.time_limit_ms);
        const std::string scene_hash = row.scene_hash;
        for (const double limit_ms : limits_ms) {
            row = permutation == 0 ? solve_within(annotated, cones, limit_ms)
                                   : solve_permuted(annotated, cones, permutation, limit_ms);
            if (row.is_proven() || row.status == SolveStatus::error) break;
        }
        row.scene_hash = scene_hash;
        return row;
    }

    /// What is known under each of the limits, without a start, and at the end of the row.
    void add_steps(SolveRow& row, const Scene& cones) {
        for (const double limit_ms : options_.gap_limits_ms) {
            if (limit_ms >= std::min(row.latency_ms, options_.time_limit_ms)) break;
            const SolveRow step = solve_with(*row.scene, cones, {.limits = {limit_ms}});
            if (step.status == SolveStatus::error) continue;
            const double time_ms = step.is_optimal() ? step.latency_ms : std::max(limit_ms, step.latency_ms);
            row.steps.push_back({time_ms, step.objective, step.bound});
        }
        std::ranges::sort(row.steps, {}, &Knowledge::time_ms);
        if (row.status != SolveStatus::error) row.steps.push_back({row.latency_ms, row.objective, row.bound});
    }

  private:
    SolveRow solve_within(const AnnotatedScene& annotated, const Scene& cones, double limit_ms) {
        std::optional<LaneGraph> start;
        const Stopwatch watch;
        if (previous_) start = map_by_cone_id(previous_->first, previous_->second, cones);
        const double mapped_ms = watch.elapsed_ms();
        SolveRow row = solve_with(annotated, cones,
                                  {.limits = {limit_ms - mapped_ms}, .start = start ? &*start : nullptr});
        row.limit_ms = limit_ms;
        row.latency_ms += mapped_ms;
        return row;
    }

    SolveRow solve_permuted(const AnnotatedScene& annotated, const Scene& cones, std::size_t permutation,
                            double limit_ms) {
        const std::uint64_t seed = permutation_seed(annotated.scene.id, permutation, options_.seed);
        const Scene shuffled = with_shuffled_cones(cones, seed);
        SolveRow row = solve_with(annotated, shuffled, {.limits = {limit_ms}, .seed = seed});
        row.permutation = permutation;
        return row;
    }

    SolveRow solve_with(const AnnotatedScene& annotated, const Scene& cones,
                        const SolveArguments& arguments) {
        const double begin_ms = thread_cpu_ms();
        const auto [problem, report, solved_ms] =
            solve_scene(solver_.solver(), cones, options_.parameters, arguments);
        SolveRow row{.scene = &annotated,
                     .size = size_,
                     .cones = cones.cones.size(),
                     .backend = backend_,
                     .status = report.status,
                     .message = report.message,
                     .lane_graph = report.lane_graph,
                     .objective = report.objective,
                     .bound = report.bound,
                     .stopped_by = report.stopped_by,
                     .nodes = report.nodes,
                     .rounds = report.rounds,
                     .build_ms = report.build_ms,
                     .limit_ms = arguments.limits.time_limit_ms,
                     .latency_ms = solved_ms,
                     .cpu_ms = thread_cpu_ms() - begin_ms,
                     .engine_ms = solver_.engine_ms()};
        row.edges =
            static_cast<std::size_t>(std::ranges::count(problem.edges, false, &ProblemEdge::high_cost));
        if (!report.lane_graph) return row;
        const Claim claim{row.is_optimal(), *report.objective, report.bound};
        const CheckReport checked = check(cones, options_.parameters, *report.lane_graph, claim);
        if (!checked.violations.empty()) {
            row.status = SolveStatus::error;
            row.message = "rejected by the checker: " + checked.violations.front();
        }
        if (backend_.warm_start) previous_.emplace(cones, *report.lane_graph);
        return row;
    }

    const Backend& backend_;
    std::size_t size_;
    const SolveOptions& options_;
    BackendSolver solver_;
    bool is_warm_ = false;
    std::optional<std::pair<Scene, LaneGraph>> previous_;
};

std::vector<const AnnotatedScene*> scenes_of_size(std::span<const AnnotatedScene> scenes, std::size_t size,
                                                  const SolveOptions& options) {
    std::vector<const AnnotatedScene*> wanted;
    for (const AnnotatedScene& scene : scenes) {
        if (options.wanted ? options.wanted(scene, size) : has_cones(scene, size)) wanted.push_back(&scene);
    }
    return spread(wanted, options.limit);
}

void drive(const Backend& backend, std::size_t size, std::span<const AnnotatedScene> scenes,
           const SolveOptions& options, ReferenceProblem* reference, SolveResults& results) {
    const std::vector<const AnnotatedScene*> wanted = scenes_of_size(scenes, size, options);
    SolveBlock block{
        .size = size, .backend = backend.label(), .version = {}, .treatment = backend.treatment()};
    if (reference != nullptr) block.reference_ms = reference->mean_ms();
    const std::vector<std::size_t> starts = lap_starts(scenes);
    Progress progress(fmt::format("{} n={}", backend.label(), size_name(size)), wanted.size());
    Driver driver(backend, size, options);
    const std::optional<PeakMemory> memory =
        reference == nullptr ? std::nullopt : std::optional<PeakMemory>(std::in_place);
    std::size_t lap = 0;
    for (const AnnotatedScene* const scene : wanted) {
        const auto place = static_cast<std::size_t>(scene - scenes.data());
        for (; lap < starts.size() && place >= starts[lap]; ++lap) driver.forget();
        const Scene cones = cones_of(*scene, size);
        results.rows.push_back(driver.solve(*scene, cones, 0));
        if (!backend.warm_start) {
            driver.add_steps(results.rows.back(), cones);
            for (std::size_t k = 1; k <= options.permutations; ++k)
                results.rows.push_back(driver.solve(*scene, cones, k));
        }
        progress.advance();
    }
    if (!driver.is_warm()) return;  // all of it was stored, and so was its block
    block.version = driver.solver().version();
    block.peak_bytes = driver.solver().end();
    if (!block.peak_bytes && memory) block.peak_bytes = memory->rise_bytes();
    results.blocks.push_back(std::move(block));
}

std::size_t count_in(const JsonNode& row, std::string_view key) {
    const auto count = row.find(key);
    return count ? static_cast<std::size_t>(count->non_negative_integer()) : 0;
}

std::optional<double> number_in(const JsonNode& row, std::string_view key) {
    const auto number = row.find(key);
    return number ? std::optional(number->number()) : std::nullopt;
}

SolveRow solve_of(const JsonNode& json) {
    using Status = SolveStatus;
    constexpr std::array kStatuses{Status::optimal, Status::feasible, Status::infeasible, Status::stopped,
                                   Status::error};
    SolveRow row;
    row.size = count_in(json, "nearest");
    row.cones = count_in(json, "cones");
    row.permutation = count_in(json, "permutation");
    row.objective = number_in(json, "objective");
    row.bound = number_in(json, "bound");
    row.status = json.member("status").one_of(kStatuses);
    if (const auto refuted = json.find("refuted")) row.refuted = refuted->boolean();
    if (const auto hash = json.find("scene_hash")) row.scene_hash = hash->string();
    if (const auto message = json.find("message")) row.message = message->string();
    row.nodes = static_cast<std::int64_t>(count_in(json, "nodes"));
    row.rounds = static_cast<int>(count_in(json, "rounds"));
    row.latency_ms = json.member("latency_ms").non_negative_number();
    row.engine_ms = number_in(json, "engine_ms");
    row.limit_ms = json.member("limit_ms").non_negative_number();
    return row;
}

SolveBlock block_of(const JsonNode& json) {
    SolveBlock block{count_in(json, "nearest"),
                     json.member("backend").string(),
                     json.member("version").string(),
                     json.member("treatment").string(),
                     json.member("reference_ms").number(),
                     {}};
    if (json.find("peak_bytes")) block.peak_bytes = count_in(json, "peak_bytes");
    return block;
}

}  // namespace

std::string size_name(std::size_t size) {
    return size == kAllVisible ? "all" : std::to_string(size);
}

Scene cones_of(const AnnotatedScene& scene, std::size_t size) {
    return size == kAllVisible ? scene.scene : nearest_ahead(scene.scene, size);
}

bool has_cones(const AnnotatedScene& scene, std::size_t size) {
    return nearest_ahead(scene.scene, size).cones.size() == size;
}

double relative_gap(double objective, double optimum) {
    return std::max(0.0, objective - optimum) / std::max(1.0, std::abs(optimum));
}

FieldValue bound_value(const std::optional<double>& bound) {
    Json json = Json::object();
    if (bound) put_bound(json, *bound, "bound");
    return json.empty() ? std::nullopt : FieldValue(json["bound"]);
}

StoredRows::StoredRows(const std::vector<std::string>& files, const std::string& parameter_hash) {
    for (const std::string& file : files) {
        for_each_json_line(file, [&](const JsonNode& json) {
            if (const auto kind = json.find("row")) {
                if (kind->string() == "block") blocks_.push_back(block_of(json));
                return;
            }
            if (json.member("parameters").string() != parameter_hash)
                json.fail_in("parameters", "are others than those of this call");
            SolveRow row = solve_of(json);
            Key key{json.member("backend").string(), json.member("scene").string(), row.size, row.cones,
                    row.permutation};
            const auto [known, is_new] = rows_.try_emplace(std::move(key), row);
            if (!is_new && row.limit_ms > known->second.limit_ms) known->second = std::move(row);
        });
    }
}

std::optional<SolveRow> StoredRows::find(const SolveRow& wanted) const {
    const auto known = rows_.find(
        {wanted.backend.label(), wanted.scene->scene.id, wanted.size, wanted.cones, wanted.permutation});
    if (known == rows_.end()) return std::nullopt;
    SolveRow row = known->second;
    if (!row.scene_hash.empty() && row.scene_hash != wanted.scene_hash) return std::nullopt;
    if (!row.is_proven() && row.limit_ms < wanted.limit_ms) return std::nullopt;
    row.scene = wanted.scene;
    row.backend = wanted.backend;
    return row;
}

SolveResults solve_scenes(std::span<const AnnotatedScene> scenes, const SolveOptions& options) {
    for (const Backend& backend : options.backends) (void)backend.takes(1);
    SolveResults results;
    if (options.stored != nullptr) results.blocks = options.stored->blocks();
    const PinnedThread pinned;
    std::optional<ReferenceProblem> reference;
    if (options.with_machine) reference.emplace();
    for (const std::size_t size : options.sizes) {
        for (const Backend& backend : options.backends) {
            if (!backend.takes(size)) continue;
            drive(backend, size, scenes, options, reference ? &*reference : nullptr, results);
        }
    }
    return results;
}

std::vector<SolveRow> solved_scenes(std::span<const AnnotatedScene> scenes, const SolveOptions& options) {
    std::vector<SolveRow> rows = solve_scenes(scenes, options).rows;
    for (const SolveRow& row : rows) {
        if (row.status == SolveStatus::error)
            throw InvalidInput(row.scene->scene.id, row.backend.solver + " failed: " + row.message);
    }
    return rows;
}

void mark_refuted_claims(std::span<SolveRow> rows) {
    using SizeAndScene = std::pair<std::size_t, const AnnotatedScene*>;
    std::map<SizeAndScene, const SolveRow*> best;
    for (const SolveRow& row : rows) {
        if (!row.objective || row.status == SolveStatus::error) continue;
        const SolveRow*& known = best[{row.size, row.scene}];
        if (known == nullptr || *row.objective < *known->objective) known = &row;
    }
    for (SolveRow& row : rows) {
        const auto known = best.find({row.size, row.scene});
        if (row.status == SolveStatus::error || known == best.end()) continue;
        const double least = *known->second->objective;
        const double most = least + kObjectiveTolerance * std::max(1.0, std::abs(least));
        const std::string other =
            fmt::format(" where {} has a lane graph of {:.9g}", known->second->backend.label(), least);
        if (row.is_infeasible()) {
            row.message = "claims that there is no lane graph" + other;
        } else if (row.is_optimal() && *row.objective > most) {
            row.message = fmt::format("claims the optimum {:.9g}", *row.objective) + other;
        } else if (row.bound && *row.bound > most) {
            row.message = fmt::format("claims the bound {:.9g}", *row.bound) + other;
        } else {
            continue;
        }
        row.refuted = true;
    }
}

AnswerErrors errors_among(std::span<const SolveRow> rows) {
    AnswerErrors errors;
    for (const SolveRow& row : rows) {
        const std::string backend = fmt::format("{} n={}", row.backend.label(), size_name(row.size));
        if (row.status == SolveStatus::error || row.refuted) {
            errors.add_error(backend, row.scene->scene.id, row.message);
        } else {
            errors.add_answer(backend);
        }
    }
    return errors;
}

SolveStudy::SolveStudy(const StudyDescription& description, SolveOptions solves)
    : SceneStudy(description), solves_(std::move(solves)) {
    std::ranges::transform(solves_.sizes, std::back_inserter(sizes_), size_name);
}

void SolveStudy::add_options(CLI::App& command) {
    SceneStudy::add_options(command);
    add_parameter_options(command, parameters_, "the defaults");
    if (!sizes_.empty()) {
        add_sizes_option(command, sizes_, "cones of a scene, the nearest ahead; `all` for all visible cones");
    }
    add_limit_option(command, solves_.limit, "scenes of each size at most, evenly spread");
    if (solves_.time_limit_ms > 0.0) add_time_limit_option(command, solves_.time_limit_ms);
}

StudyResult SolveStudy::measure(const SceneSet& set) {
    SolveOptions solves = solves_;
    solves.parameters = parameters_.load();
    solves.sizes.clear();
    for (const std::optional<std::size_t>& size : cone_set_sizes("--sizes", sizes_))
        solves.sizes.push_back(size.value_or(kAllVisible));
    return aggregate(set, std::move(solves));
}

void add_limit_option(CLI::App& command, std::optional<std::size_t>& limit, const std::string& description) {
    command.add_option("--limit", limit, description)->check(whole_number(1, 1'000'000));
}

CLI::Option* add_limits_option(CLI::App& command, const std::string& name, std::vector<double>& limits_ms,
                               const std::string& description) {
    return command.add_option(name, limits_ms, description)
        ->delimiter(',')
        ->check(CLI::Range(0.1, 1e7) & !CLI::IsMember({"nan", "-nan"}, CLI::ignore_case));
}

void require_ascending(const std::string& name, const std::vector<double>& limits_ms) {
    if (!std::ranges::is_sorted(limits_ms, std::less_equal()))
        throw InvalidInput(name, "must be in ascending order");
}

}  // namespace conelane::experiments
