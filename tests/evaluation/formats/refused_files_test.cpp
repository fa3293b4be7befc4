// What readers of files say of faulty ones: refused_files.txt has texts and messages.

#include "evaluation/formats/frame_file.hpp"
#include "evaluation/formats/lane_file.hpp"
#include "evaluation/formats/program_solution.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/formats/solution_file.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/small_program.hpp"
#include "tests/support/text_tables.hpp"

namespace conelane {
namespace {

class RefusedFiles : public FileTest, public testing::WithParamInterface<tests::TableSection> {
  protected:
    using Reader = std::function<void(const std::string& text)>;

    void fsd(const std::string& map, const std::string& boundaries) const {
        file_with(map, "cone_map_3.yaml");
        file_with(boundaries, "boundaries_3.yaml");
        (void)read_fsd_track(path(""), 3);
    }
    /// Throws what is wrong with a solution of the small program, or with its point.
    static void read_solution(const std::string& text) {
        std::istringstream in(text);
        const SolutionFile solution = read_solution_file(in, tests::small_program());
        const std::string fault = fault_of(solution, tests::small_program());
        if (!fault.empty()) throw std::runtime_error(fault);
    }
    /// The message without the folder.
    [[nodiscard]] std::string message_on(const std::string& text) const {
        try {
            readers_.at(tests::split(GetParam().name, ".").front())(text);
        } catch (const std::runtime_error& error) {  // InputError, too
            return tests::replaced(error.what(), path("").string(), "");
        } catch (const InvalidInput& error) {
            return error.what();
        }
        return "accepted";
    }
    const std::map<std::string, Reader> readers_{
        {"scenes", [this](const std::string& text) { (void)read_scenes(file_with(text, "s")); }},
        {"boundaries",
         [this](const std::string& text) { (void)read_track_boundaries(file_with(text, "t")); }},
        {"lanes", [this](const std::string& text) { (void)read_lanes(file_with(text, "l")); }},
        {"solutions", [this](const std::string& text) { (void)read_solutions(file_with(text, "s")); }},
        {"log", [this](const std::string& text) { (void)read_run_log(file_with(text, "run.json")); }},
        {"fsd_map",
         [this](const std::string& text) { fsd(text, "left: [10, 11, 12]\nright: [20, 21, 22]\n"); }},
        {"fsd_boundaries",
         [this](const std::string& text) {
             fsd("10: [0, 0]\n11: [8, 0]\n12: [4, 8]\n20: [-4, -3]\n21: [12, -3]\n22: [4, 14.5]\n", text);
         }},
        {"pacsim", [this](const std::string& text) { (void)read_pacsim_track(file_with(text, "t.yaml")); }},
        {"eufs", [this](const std::string& text) { (void)read_eufs_track(file_with(text, "t.csv")); }},
        {"tracks", [](const std::string& spec) { (void)load_tracks(spec); }},
        {"solution", read_solution}};
};

TEST_P(RefusedFiles, AreNamedAsTheTableSays) {
    for (const std::string& line : GetParam().lines) {
        const bool is_whole = line.find(" => ") != std::string::npos;
        const std::vector<std::string> parts = tests::split(line, is_whole ? " => " : " =~ ");
        ASSERT_EQ(parts.size(), 2U) << line;
        const std::string text = tests::replaced(tests::replaced(parts[0], "\\n", "\n"), "\\r", "\r");
        EXPECT_THAT(message_on(text),
                    is_whole ? testing::Matcher<std::string>(parts[1]) : testing::HasSubstr(parts[1]))
            << line;
    }
}
INSTANTIATE_TEST_SUITE_P(Each, RefusedFiles,
                         testing::ValuesIn(tests::table_sections("evaluation/formats/refused_files.txt")),
                         [](const auto& tested) { return tests::replaced(tested.param.name, ".", "_"); });

}  // namespace
}  // namespace conelane
