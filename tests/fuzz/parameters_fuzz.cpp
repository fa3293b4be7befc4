// Readers of everything that tells a run what to do: RLD parameters, the cards of detectors, the record of a
// run, and the names of detectors from outside.

#include "experiments/comparison/run_record.hpp"
#include "tests/fuzz/expectations.hpp"
#include "tests/fuzz/scratch_folder.hpp"

namespace conelane::fuzz {
namespace {

void read_all(std::string_view bytes) {
    static const ScratchFolder folder;
    const auto file = folder.write("input.json", bytes);
    answers([&] {
        const RldParameters parameters = read_rld_parameters(file);
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
    answers([&] { (void)read_detector_card(file).summary(); });
    const std::string text(bytes);
    (void)folder.write("run.json", bytes);
    answers([&] { (void)experiments::read_run_record(folder.path()); });
    answers([&] { (void)experiments::parse_method(text); });
    (void)split_detectors({text});
}

}  // namespace
}  // namespace conelane::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    conelane::fuzz::read_all({reinterpret_cast<const char*>(data), size});
    return 0;
}
