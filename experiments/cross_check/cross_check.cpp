#include "experiments/cross_check/cross_check.hpp"

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/provenance.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/progress/progress.hpp"
#include "model/deadline.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kCasesOfABlock = 64;  // cases between two writes
constexpr std::array kOutcomes{CrossCheckOutcome::same_optimum, CrossCheckOutcome::infeasible,
                               CrossCheckOutcome::undecided, CrossCheckOutcome::differ};

/// Everything that the cases and their verdicts depend on, apart from the clock.
nlohmann::ordered_json record_of(const CrossCheckOptions& options) {
    const Provenance origin = provenance();
    nlohmann::ordered_json scenes = nlohmann::ordered_json::array();
    for (const fs::path& file : options.scenes)
        scenes.push_back({{"file", file.string()}, {"hash", file_hash(file)}});
    return {{"commit", origin.commit},    {"seed", options.seed},
            {"first", options.first},     {"scenes", scenes},
            {"solvers", options.solvers}, {"time_limit_ms", options.time_limit_ms}};
}

struct JudgedCase {
    CrossCheckCase drawn;
    CrossCheckVerdict verdict;
};

nlohmann::ordered_json line_of(const JudgedCase& judged) {
    const auto& [drawn, verdict] = judged;
    nlohmann::ordered_json json{{"case", drawn.number},
                                {"kind", drawn.kind},
                                {"cones", drawn.scene.cones.size()},
                                {"formulation", to_string(drawn.formulation)},
                                {"outcome", to_string(verdict.outcome)},
                                {"certified", verdict.certified}};
    if (verdict.objective) json["objective"] = *verdict.objective;
    if (!verdict.findings.empty()) json["findings"] = verdict.findings;
    return json;
}

/// The lines of an earlier run, to which new lines are added.
class CaseLog {
  public:
    /// Throws InputError if the file holds another run.
    CaseLog(const fs::path& file, const nlohmann::ordered_json& record, CrossCheckSummary& summary)
        : file_(file), summary_(summary) {
        const std::uintmax_t whole = fs::exists(file) ? read(record) : 0;
        std::error_code failure;
        if (fs::exists(file)) fs::resize_file(file, whole, failure);
        stream_.open(file, std::ios::binary | std::ios::app);
        if (!stream_) failure = std::error_code(errno, std::generic_category());
        if (failure) throw InputError(file, 0, "", "cannot be written: " + failure.message());
        if (whole == 0) write(to_line(record));
    }

    void append(const JudgedCase& judged) {
        write(to_line(line_of(judged)));
        count(judged.verdict.outcome, judged.verdict.certified);
    }

  private:
    /// Length of the whole lines.
    std::uintmax_t read(const nlohmann::ordered_json& record) {
        std::ifstream stream(file_, std::ios::binary);
        std::uintmax_t length = 0;
        std::string line;
        for (std::size_t number = 1; std::getline(stream, line) && !stream.eof(); ++number) {
            length += line.size() + 1;
            if (number == 1) {
                const auto stored = nlohmann::ordered_json::parse(line, nullptr, false);
                if (stored != record)
                    throw InputError(file_, 1, "", "holds a run with other options or of another program");
                continue;
            }
            with_json_line(line, file_, number, [&](const JsonNode& json) {
                count(json.member("outcome").one_of(kOutcomes), json.member("certified").boolean());
            });
        }
        return length;
    }
    void count(CrossCheckOutcome outcome, bool certified) {
        ++summary_.cases;
        ++summary_.outcomes[outcome];
        if (certified) ++summary_.certified;
    }
    void write(const std::string& line) {
        stream_ << line << '\n';
        stream_.flush();
        stream_.require_written(file_);
    }

    fs::path file_;
    CrossCheckSummary& summary_;
    OutputStream stream_;
};

/// Subject and kind of a finding: "glpk (tight)", "cbc (paper): error".
std::string subject_of(const std::string& finding) {
    const std::string who = finding.substr(0, std::min(finding.find(" within "), finding.find(": ")));
    return finding.find(": error, ") == std::string::npos ? who : who + ": error";
}

class CrossCheck {
  public:
    CrossCheck(const CrossCheckOptions& options, fs::path directory)
        : options_(options), directory_(std::move(directory)) {
        for (const fs::path& file : options.scenes)
            std::ranges::move(read_scenes(file), std::back_inserter(given_));
        (void)solvers(Formulation::tight);  // reports a wrong name before the work
    }

    CrossCheckSummary run() {
        const Stopwatch watch;
        std::error_code failure;
        fs::create_directories(directory_, failure);
        if (failure) throw InputError(directory_, 0, "", "cannot be made: " + failure.message());
        const FolderLock lock(directory_);
        CrossCheckSummary summary;
        CaseLog log(directory_ / "cases.jsonl", record_of(options_), summary);
        const std::size_t done = summary.cases;
        Progress progress("cross-check", options_.cases - std::min(done, options_.cases));
        for (std::size_t next = done; next < options_.cases; next += kCasesOfABlock) {
            const std::size_t count = std::min(kCasesOfABlock, options_.cases - next);
            for (const JudgedCase& judged : judge_block(options_.first + next, count, progress)) {
                if (judged.verdict.outcome == CrossCheckOutcome::differ) write_shrunk(judged);
                log.append(judged);
                ++summary.added;
                summary.tight_answers += judged.verdict.tight_answers;
                summary.tight_proofs += judged.verdict.tight_proofs;
            }
        }
        summary.seconds = watch.elapsed_ms() / 1000.0;
        return summary;
    }

  private:
    [[nodiscard]] std::vector<CheckedSolver> solvers(Formulation formulation) const {
        return options_.make_solvers ? options_.make_solvers(formulation)
                                     : make_checked_solvers(options_.solvers, formulation);
    }

    /// With new solvers, so that it does not depend on earlier cases.
    [[nodiscard]] CrossCheckVerdict verdict_on(const CrossCheckCase& drawn) const {
        return judge(drawn, solvers(drawn.formulation), options_.time_limit_ms);
    }

    [[nodiscard]] std::vector<JudgedCase> judge_block(std::size_t first, std::size_t count,
                                                      Progress& progress) const {
        std::vector<JudgedCase> block(count);
        const auto judge_one = [&](std::size_t k) {
            block[k].drawn = draw_cross_check_case(given_, options_.seed, first + k);
            block[k].verdict = verdict_on(block[k].drawn);
            progress.advance();
        };
        // oneTBB warns if there are more arenas than processors.
        const int threads =
            std::min(static_cast<int>(options_.threads), oneapi::tbb::info::default_concurrency());
        oneapi::tbb::task_arena arena(threads);
        arena.execute([&] { oneapi::tbb::parallel_for(std::size_t{0}, count, judge_one); });
        return block;
    }

    void write_shrunk(const JudgedCase& judged) const {
        CrossCheckVerdict verdict = judged.verdict;
        // Under a tight limit a difference may not occur again, so the case is kept as it was. A different
        // difference met while shrinking does not count: it would hide the first one.
        const std::string subject = subject_of(judged.verdict.findings.front());
        const CrossCheckCase shrunk = shrink(judged.drawn, [&](const CrossCheckCase& smaller) {
            CrossCheckVerdict again = verdict_on(smaller);
            const auto is_the_same = [&](const std::string& found) { return subject_of(found) == subject; };
            if (std::ranges::none_of(again.findings, is_the_same)) return false;
            verdict = std::move(again);
            return true;
        });
        (void)write_case(directory_, {shrunk, options_.solvers, options_.time_limit_ms}, verdict.findings);
    }

    const CrossCheckOptions& options_;
    fs::path directory_;
    std::vector<AnnotatedScene> given_;
};

}  // namespace

CrossCheckSummary cross_check(const CrossCheckOptions& options, const fs::path& directory) {
    return CrossCheck(options, directory).run();
}

std::string to_text(const CrossCheckSummary& summary) {
    const auto count = [&](CrossCheckOutcome outcome) {
        const auto found = summary.outcomes.find(outcome);
        return found == summary.outcomes.end() ? std::size_t{0} : found->second;
    };
    return fmt::format(
        "{} cases: {} the same optimum, {} infeasible, {} undecided, {} differ; {} proofs repeated in "
        "rational arithmetic\n"
        "{} of them by this run, {:.1f} a second; under tight limits {} answers, {} of them proofs\n",
        summary.cases, count(CrossCheckOutcome::same_optimum), count(CrossCheckOutcome::infeasible),
        count(CrossCheckOutcome::undecided), count(CrossCheckOutcome::differ), summary.certified,
        summary.added, summary.seconds > 0.0 ? static_cast<double>(summary.added) / summary.seconds : 0.0,
        summary.tight_answers, summary.tight_proofs);
}

CrossCheckVerdict judge_stored_case(const fs::path& file, std::size_t repetitions) {
    const StoredCase stored = read_case(file);
    CrossCheckVerdict verdict;
    for (std::size_t k = 0; k < repetitions && verdict.findings.empty(); ++k) {
        verdict = judge(stored.drawn, make_checked_solvers(stored.solvers, stored.drawn.formulation),
                        stored.time_limit_ms);
    }
    return verdict;
}

}  // namespace conelane::experiments
