// Readers of everything that tells a run what to do: RLD parameters, those of other detectors, the
// cards of detectors, the record of a tuning, round trips of an echo, and the names of detectors from
// outside.

#include "evaluation/files/detector_parameter_file.hpp"
#include "evaluation/files/parameter_file.hpp"
#include "evaluation/outside/outside_detector.hpp"
#include "experiments/comparison/echo_floor.hpp"
#include "experiments/comparison/known_detectors.hpp"
#include "experiments/studies/confidence_and_colour.hpp"
#include "tests/fuzz/expectations.hpp"
#include "tests/fuzz/scratch_folder.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace conelane::fuzz {
namespace {

void read_all(std::string_view bytes) {
    static const ScratchFolder folder;
    const auto file = folder.write("input.json", bytes);
    answers([&] {
        const RldParameters parameters = parse_rld_parameters(bytes, "input.json");
        validate(parameters);
        const auto again = folder.path() / "again.json";
        write_rld_parameters(again, parameters);
        const RldParameters read = read_rld_parameters(again);
        for (const auto& fields : {rld_parameter_fields(), rld_extra_fields()}) {
            for (const RldParameterField& field : fields) {
                require(read.*field.value == parameters.*field.value,
                        "parameters are read as they were written");
            }
        }
    });
    answers([&] { (void)make_delaunay_beam_detector(parse_delaunay_beam_parameters(bytes, "input.json")); });
    answers([&] { (void)make_astar_lane_detector(parse_astar_lane_parameters(bytes, "input.json")); });
    answers([&] { (void)read_detector_card(file).summary(); });
    answers([&] { (void)experiments::read_echo_floor(file); });
    answers([&] { (void)experiments::read_tuning_record(file); });
    const std::string text(bytes);
    answers([&] { (void)outside_detectors_of_record(text); });
    answers([&] { (void)experiments::find_outside_detector(text); });
    (void)split_detectors({text});
}

}  // namespace
}  // namespace conelane::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    conelane::fuzz::read_all({reinterpret_cast<const char*>(data), size});
    return 0;
}
