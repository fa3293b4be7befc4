// Readers of answers of detectors and solvers: lanes, lanes from outside, the log of an unfinished run,
// solutions, and the solution files of other solvers. What is read can be written and read again.

#include "evaluation/formats/program_solution.hpp"
#include "evaluation/formats/solution_file.hpp"
#include "experiments/comparison/runner.hpp"
#include "model/lane_graph_model.hpp"
#include "tests/fuzz/expectations.hpp"
#include "tests/fuzz/scratch_folder.hpp"
#include "tests/support/six_cone_lane.hpp"

#include <sstream>

namespace conelane::fuzz {
namespace {

void read_lanes(std::string_view bytes, const std::filesystem::path& file, const ScratchFolder& folder) {
    answers([&] {
        const std::vector<LaneRecord> records = conelane::read_lanes(file);
        const auto again = folder.path() / "again.lanes.jsonl";
        write_lanes(again, records);
        require(conelane::read_lanes(again).size() == records.size(), "every lane is written");
    });
    answers([&] { (void)read_foreign_lanes(file); });
    answers([&] { (void)read_foreign_lane(bytes); });
    std::filesystem::remove(folder.path() / "log.lanes.jsonl");
    (void)folder.write("log.lanes.jsonl.part", bytes);
    answers([&] {
        experiments::LaneLog log(folder.path() / "log.lanes.jsonl");
        log.keep(log.stored() / 2);
        log.append(std::vector<LaneRecord>(1));
        log.finish();
    });
}

void read_solutions(const std::filesystem::path& file, const ScratchFolder& folder) {
    answers([&] {
        const std::vector<SolutionRecord> records = conelane::read_solutions(file);
        const auto again = folder.path() / "again.solutions.jsonl";
        write_solutions(again, records);
        require(conelane::read_solutions(again).size() == records.size(), "every solution is written");
    });
}

void read_solution_of_a_program(std::string_view bytes) {
    static const LaneGraphProblem problem = make_problem(tests::six_cone_lane(), {});
    static const LaneGraphModel model(problem, Formulation::tight);
    std::istringstream stream{std::string(bytes)};
    answers([&] {
        const SolutionFile solution = read_solution_file(stream, model.program());
        require(solution.point.empty() || solution.point.size() == model.program().columns.size(),
                "a point has a value for each column");
        if (!solution.point.empty()) (void)model.decode(solution.point);
    });
}

void read_all(std::string_view bytes) {
    static const ScratchFolder folder;
    const auto file = folder.write("input.jsonl", bytes);
    read_lanes(bytes, file, folder);
    read_solutions(file, folder);
    read_solution_of_a_program(bytes);
}

}  // namespace
}  // namespace conelane::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    conelane::fuzz::read_all({reinterpret_cast<const char*>(data), size});
    return 0;
}
