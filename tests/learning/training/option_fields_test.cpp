// The tables of options: their ranges, and that each training is described by them.

#include "learning/training/clc_training.hpp"
#include "learning/training/front_training.hpp"
#include "learning/training/rld_training.hpp"
#include "tests/support/refusal.hpp"

namespace conelane::learning {
namespace {

using Values = std::vector<std::pair<std::string, double>>;

/// Sets the number of that option or, if it has none, of that key.
void set(const OptionFields& fields, const std::string& name, double number) {
    for (const OptionField& field : fields) {
        if (field.option != name && (*field.option != '\0' || field.key != name)) continue;
        std::visit(
            [&](const auto& value) {
                using Value = std::decay_t<decltype(value)>;
                using Number = std::remove_pointer_t<Value>;
                if constexpr (std::is_arithmetic_v<Number> && !std::is_const_v<Number>)
                    *value = static_cast<Number>(number);
            },
            field.value);
        return;
    }
    ADD_FAILURE() << "no option " << name;
}

template <typename Options>
void expect_named(const Values& invalid) {
    Options valid;
    EXPECT_NO_THROW(require_in_range(option_fields(valid)));
    for (const auto& [name, number] : invalid) {
        Options options;
        set(option_fields(options), name, number);
        EXPECT_EQ(refused_key([&] { require_in_range(option_fields(options)); }), name) << number;
    }
}

TEST(OptionFields, NameTheOneThatIsOutOfItsRange) {
    const double nan = std::nan("");
    expect_named<FrontTrainingOptions>({{"--draws", 0},
                                        {"--scenes-a-draw", 0},
                                        {"--colored-share", 1.1},
                                        {"--noise-share", 1.1},
                                        {"--noise-share", -0.1},
                                        {"--highest-rate", 0.0},
                                        {"--highest-rate", 1.0},
                                        {"--fall-out", -1.0},
                                        {"--listwise", HUGE_VAL},
                                        {"--imitation-rate", -1.0},
                                        {"--search-rate", 0.0},
                                        {"--judge-rate", nan},
                                        {"--beam", 0},
                                        {"--trusted", 0.0},
                                        {"--trusted", 1.5},
                                        {"--figures-every", 0},
                                        {"--checkpoint-every", 0},
                                        {"--threads", 0},
                                        {"through_search.drop", nan}});
    expect_named<RldTrainingOptions>({{"--draws", 0},
                                      {"--units", 300},
                                      {"--rate", 0.0},
                                      {"--rate", HUGE_VAL},
                                      {"--margin", -1.0},
                                      {"--far-margin", -1.0},
                                      {"--max-work", 0},
                                      {"--report-every", 0}});
    expect_named<RankNetTrainingOptions>({{"--units", 0},
                                          {"--epochs", 0},
                                          {"pairs_a_step", 0},
                                          {"--scenes-a-step", 0},
                                          {"--rate", 0.0},
                                          {"--decay", -1.0},
                                          {"--iou-factor", 0.0},
                                          {"--divergence-penalty", -1.0},
                                          {"--late-divergence-penalty", -1.0},
                                          {"--unusable-penalty", -1.0},
                                          {"--leader-share", 1.5}});
    expect_named<StepScoreTrainingOptions>(
        {{"--step-epochs", 0}, {"--step-rate", 0.0}, {"--step-decay", -1.0}});
    const auto noise_key = [](auto change) {
        FrontTrainingOptions options;
        change(options.scenes);
        return refused_key([&] { validate(options); });
    };
    EXPECT_EQ(noise_key([](auto& scenes) { scenes.noise_cones = {9, 8}; }), "--noise-cones");
    EXPECT_EQ(noise_key([](auto& scenes) { scenes.noise_cones = {0, 8}; }), "--noise-cones");
    EXPECT_EQ(noise_key([](auto& scenes) { scenes.noise_ranges_m = {0.0, 8.0}; }), "--noise-ranges");
    EXPECT_EQ(noise_key([](auto& scenes) { scenes.noise_ranges_m = {9.0, 8.0}; }), "--noise-ranges");
}

TEST(OptionFields, AreTheRecordInTheirOrder) {
    double rate = 0.5;
    std::size_t steps = 3;
    bool warp = false;
    std::vector<std::string> parts{"rank"};
    const OptionFields fields{{"--steps", "stage.steps", &steps}, {"", "stage.rate", &rate},
                              {"!--no-warp", "warp", &warp},      {"--hidden", "", &steps},
                              {"--parts", "parts", &parts},       {"", "loss", "pairs"}};
    EXPECT_EQ(record_of(fields).dump(),
              R"({"stage":{"steps":3,"rate":0.5},"warp":false,"parts":["rank"],"loss":"pairs"})");
}

}  // namespace
}  // namespace conelane::learning
