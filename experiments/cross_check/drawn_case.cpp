#include "conelane/learned_costs.hpp"
#include "evaluation/formats/program_files.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/seeded_random.hpp"
#include "experiments/cross_check/cross_check.hpp"
#include "model/lane_graph_model.hpp"

#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

/// Drawn numbers are rounded, or made without functions whose last digit depends on the machine's library.
class Draw {
  public:
    explicit Draw(const boost::random::mt19937_64& random) : random_(random) {}

    double real(double low, double high) {
        return boost::random::uniform_real_distribution<double>(low, high)(random_);
    }
    std::size_t index(std::size_t count) {
        return boost::random::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
    }
    int integer(int low, int high) {
        return boost::random::uniform_int_distribution<int>(low, high)(random_);
    }
    bool chance(double probability) { return real(0.0, 1.0) < probability; }
    template <std::size_t count>
    double one_of(const std::array<double, count>& values) {
        return values[index(count)];
    }
    boost::random::mt19937_64& generator() { return random_; }

  private:
    boost::random::mt19937_64 random_;
};

double rounded(double value) {
    return std::round(value * 1e4) / 1e4;
}

void add_cone(Scene& scene, double x, double y) {
    scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), {x, y}});
}

std::size_t cone_count(Draw& draw) {
    if (draw.chance(0.03)) return static_cast<std::size_t>(draw.integer(1, 3));
    if (draw.chance(0.7)) return static_cast<std::size_t>(draw.integer(4, 9));
    return static_cast<std::size_t>(draw.chance(0.85) ? draw.integer(10, 14) : draw.integer(15, 24));
}

void make_lane(CrossCheckCase& drawn, Draw& draw, std::size_t cones) {
    Scene& scene = drawn.scene;
    scene.pose.yaw_rad = draw.integer(-3141, 3141) / 1000.0;
    scene.pose.position = {static_cast<double>(draw.integer(-50, 50)),
                           static_cast<double>(draw.integer(-50, 50))};
    const Point ahead = scene.pose.heading();
    const Point left(-ahead.y(), ahead.x());
    const double curvature = draw.real(-0.08, 0.08);
    const double half_width = draw.real(1.4, 2.4);
    const double spacing = draw.real(2.0, 4.0);
    const double false_share = draw.one_of(std::array{0.0, 0.15, 0.4});
    for (std::size_t i = 0; i < cones; ++i) {
        double x = draw.real(0.0, 14.0);
        double y = draw.real(-7.0, 7.0);
        if (!draw.chance(false_share)) {
            const std::size_t pair = i / 2;
            x = 1.0 + spacing * static_cast<double>(pair) + draw.real(-0.4, 0.4);
            y = 0.5 * curvature * x * x + (i % 2 == 0 ? half_width : -half_width) + draw.real(-0.3, 0.3);
        }
        const Point place = scene.pose.position + x * ahead + y * left;
        add_cone(scene, rounded(place.x()), rounded(place.y()));
    }
}

void make_strewn(CrossCheckCase& drawn, Draw& draw, std::size_t cones) {
    drawn.scene.pose.yaw_rad = draw.integer(-3141, 3141) / 1000.0;
    const double half_side = draw.real(3.0, 10.0);
    for (std::size_t i = 0; i < cones; ++i) {
        add_cone(drawn.scene, rounded(draw.real(-half_side, half_side)),
                 rounded(draw.real(-half_side, half_side)));
    }
}

void make_collinear(CrossCheckCase& drawn, Draw& draw, std::size_t cones) {
    constexpr std::array kSteps{0.5, 1.0, 2.0, 2.5, 3.0, 3.2};
    constexpr std::array kWidths{1.0, 2.5, 3.0, 3.5, 4.0};
    const double step = draw.one_of(kSteps);
    const bool is_lane = draw.chance(0.6);
    const double width = is_lane ? draw.one_of(kWidths) : 0.0;
    const double offset = is_lane ? -width / 2.0 : draw.integer(-2, 2);
    // Along an axis the line is exact; along a slope it is nearly exact.
    const bool slopes = draw.chance(0.3);
    if (slopes) drawn.scene.pose.yaw_rad = 0.75;
    const Point ahead = drawn.scene.pose.heading();
    for (std::size_t i = 0; i < cones; ++i) {
        const std::size_t place = is_lane ? i / 2 : i;
        const double along = step * static_cast<double>(place);
        const double across = offset + (is_lane && i % 2 == 0 ? width : 0.0);
        add_cone(drawn.scene, along * ahead.x() - across * ahead.y(), along * ahead.y() + across * ahead.x());
    }
}

void make_lattice(CrossCheckCase& drawn, Draw& draw, std::size_t cones) {
    constexpr std::array kSteps{1.0, 2.0, 2.5, 3.0, 3.2, 3.5};
    const double step = draw.one_of(kSteps);
    for (std::size_t i = 0; i < cones; ++i)
        add_cone(drawn.scene, step * draw.integer(0, 4), step * (draw.integer(-2, 2) + 0.5));
    RldParameters& parameters = drawn.parameters;
    if (draw.chance(0.5)) parameters.d_e = step;
    if (draw.chance(0.5)) parameters.d_min = step;
    if (draw.chance(0.5)) parameters.d_near = 2.0 * step;
    if (draw.chance(0.5)) parameters.d_max = step;
}

void make_coincident(CrossCheckCase& drawn, Draw& draw, std::size_t cones) {
    constexpr std::array kBeside_m{0.0, 1e-13, 1e-9, 1e-6, 1e-3, 0.05};
    make_lane(drawn, draw, cones);
    std::vector<Cone>& all = drawn.scene.cones;
    const auto copies = static_cast<int>(1 + draw.index(std::max<std::size_t>(1, cones / 2)));
    for (int k = 0; k < copies; ++k) {
        const Point& other = all[draw.index(cones)].position;
        const Point beside(draw.one_of(kBeside_m), draw.one_of(kBeside_m));
        all[draw.index(cones)].position = other + beside;
    }
}

void make_symmetric(CrossCheckCase& drawn, Draw& draw, std::size_t cones) {
    for (std::size_t i = 0; i < cones; i += 2) {
        const double x = rounded(draw.chance(0.7) ? 1.0 + 1.5 * static_cast<double>(i) + draw.real(-0.4, 0.4)
                                                  : draw.real(0.0, 12.0));
        const double y = rounded(draw.chance(0.7) ? draw.real(1.4, 2.4) : draw.real(0.0, 6.0));
        add_cone(drawn.scene, x, y);
        if (i + 1 < cones) add_cone(drawn.scene, x, -y);
    }
}

/// The scene's value that the parameter limits, or nothing.
double measure(const CrossCheckCase& drawn, double RldParameters::*limit, Draw& draw) {
    const std::vector<Cone>& cones = drawn.scene.cones;
    const auto any = [&] { return cones[draw.index(cones.size())].position; };
    const Point a = any();
    const Point b = any();
    if (limit == &RldParameters::d_near || limit == &RldParameters::d_h)
        return (a - drawn.scene.pose.position).norm();
    if (limit == &RldParameters::d_max || limit == &RldParameters::d_min) return (a - b).norm();
    const LaneGraphProblem problem = make_problem(drawn.scene, drawn.parameters, EdgeExtent::all_pairs);
    if (limit == &RldParameters::s_crit)
        return problem.edges.empty() ? 0.0 : problem.edges[draw.index(problem.edges.size())].spacing_cost;
    return problem.turns.empty() ? 0.0 : problem.turns[draw.index(problem.turns.size())].angle_cost;
}

void make_at_limits(CrossCheckCase& drawn, Draw& draw, std::size_t cones) {
    // Offsets from a limit that are clearly inside or outside: the tolerance is 1e-9.
    constexpr std::array kBeside{0.0, 0.0, 1e-12, -1e-12, 1e-7, -1e-7};
    constexpr std::array kLimits{&RldParameters::d_near, &RldParameters::d_max,  &RldParameters::d_min,
                                 &RldParameters::d_h,    &RldParameters::s_crit, &RldParameters::t_crit};
    make_lane(drawn, draw, cones);
    const int limits = draw.integer(1, 3);
    for (int k = 0; k < limits; ++k) {
        double RldParameters::*const limit = kLimits[draw.index(kLimits.size())];
        const double met = measure(drawn, limit, draw) + draw.one_of(kBeside);
        const auto field = std::ranges::find(rld_parameter_fields(), limit, &RldParameterField::value);
        drawn.parameters.*limit = std::clamp(met, field->lowest, field->highest);
    }
}

struct Kind {
    std::string_view name;
    void (*make)(CrossCheckCase&, Draw&, std::size_t cones);
};

void make_far_away(CrossCheckCase& drawn, Draw& draw, std::size_t cones);
void make_scaled(CrossCheckCase& drawn, Draw& draw, std::size_t cones);

constexpr std::array kKinds{
    Kind{"lane", make_lane},           Kind{"strewn", make_strewn},         Kind{"collinear", make_collinear},
    Kind{"lattice", make_lattice},     Kind{"coincident", make_coincident}, Kind{"symmetric", make_symmetric},
    Kind{"at_limits", make_at_limits}, Kind{"far_away", make_far_away},     Kind{"scaled", make_scaled}};
constexpr std::size_t kPlainKinds = 7;  // number of kinds before those that change one of them

void make_far_away(CrossCheckCase& drawn, Draw& draw, std::size_t cones) {
    constexpr std::array kAway_m{1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e10, 1e12};
    kKinds[draw.index(kPlainKinds)].make(drawn, draw, cones);
    const double away = draw.one_of(kAway_m);
    const Point shift(draw.integer(-1, 1) * away, draw.integer(-1, 1) * away + 0.3);
    drawn.scene.pose.position += shift;
    for (Cone& cone : drawn.scene.cones) cone.position += shift;
}

void make_scaled(CrossCheckCase& drawn, Draw& draw, std::size_t cones) {
    constexpr std::array kFactors{1e-300, 1e-160, 1e-12, 1e-6, 1e-3, 0.03,  0.3,
                                  3.0,    30.0,   1e3,   1e6,  1e9,  1e160, 1e300};
    kKinds[draw.index(kPlainKinds)].make(drawn, draw, cones);
    const double factor = draw.one_of(kFactors);
    drawn.scene.pose.position *= factor;
    for (Cone& cone : drawn.scene.cones) cone.position *= factor;
    if (draw.chance(0.3)) return;
    for (const auto& fields : {rld_parameter_fields(), rld_extra_fields()}) {
        for (const RldParameterField& field : fields) {
            double& value = drawn.parameters.*field.value;
            if (field.unit == "m") value = std::clamp(value * factor, field.lowest, field.highest);
        }
    }
}

void draw_parameters(RldParameters& parameters, Draw& draw) {
    constexpr std::array kFactors{0.0, 0.5, 0.8, 1.25, 2.0};
    if (draw.chance(0.5)) parameters = with_shape_costs(parameters);
    if (draw.chance(0.5)) {
        for (const auto& fields : {rld_parameter_fields(), rld_extra_fields()}) {
            for (const RldParameterField& field : fields) {
                if (!draw.chance(0.15)) continue;
                const double factor = draw.chance(0.8) ? draw.real(0.6, 1.6) : draw.one_of(kFactors);
                parameters.*field.value =
                    std::clamp(parameters.*field.value * factor, field.lowest, field.highest);
            }
        }
    }
    if (draw.chance(0.2)) parameters.w_color = draw.real(0.1, 2.0);
    parameters.use_confidence = draw.chance(0.2);
    parameters.forbid_crossing = draw.chance(0.2);
    parameters.pairing = draw.chance(0.5) ? Pairing::paper : Pairing::near_far;
}

/// Edges over gaps and to the nearest cones, near endpoints by the car's axis, and learned costs of any sign.
void draw_learned_costs(RldParameters& parameters, Draw& draw) {
    constexpr std::size_t kUnits = 4;
    if (draw.chance(0.5)) {
        parameters.d_gap = rounded(draw.real(5.0, 12.0));
        parameters.theta_gap = rounded(draw.real(0.1, 1.0));
        if (draw.chance(0.5)) parameters.d_clear = rounded(draw.real(0.1, 1.0));
    }
    if (draw.chance(0.3)) parameters.d_side = rounded(draw.real(1.0, 6.0));
    if (draw.chance(0.5)) parameters.nearest_of_edge = draw.integer(2, 8);
    if (draw.chance(0.5)) parameters.nearest_of_gap = draw.integer(2, 16);
    LearnedCosts costs = LearnedCosts::zero(draw.chance(0.5) ? kUnits : 0);
    for (LearnedNetwork& network : costs.networks) {
        for (std::vector<double>* list : {&network.linear, &network.hidden, &network.output}) {
            for (double& number : *list) number = rounded(draw.real(-0.6, 0.6));
        }
    }
    parameters.learned_costs = std::make_shared<const LearnedCosts>(std::move(costs));
}

void draw_colors_and_confidences(Scene& scene, Draw& draw) {
    constexpr std::array kColors{ConeColor::unknown, ConeColor::blue, ConeColor::yellow, ConeColor::orange};
    const bool with_color = draw.chance(0.3);
    const bool with_confidence = draw.chance(0.3);
    for (Cone& cone : scene.cones) {
        if (with_color) cone.color = kColors[draw.index(kColors.size())];
        if (with_color && draw.chance(0.2)) {
            const double blue = rounded(draw.real(0.0, 1.0));
            cone.color_probabilities = {.blue = blue, .yellow = 1.0 - blue};
        }
        if (with_confidence) cone.confidence = rounded(draw.real(0.0, 1.0));
    }
}

class Shrinking {
  public:
    Shrinking(CrossCheckCase drawn, const std::function<bool(const CrossCheckCase&)>& differs,
              std::size_t max_trials)
        : smallest_(std::move(drawn)), differs_(differs), trials_left_(max_trials) {}

    CrossCheckCase run() {
        for (std::size_t together = smallest_.scene.cones.size() / 2; together > 1; together /= 2)
            (void)remove_cones(together);
        while (remove_cones(1)) {
        }
        reset_parameters();
        while (remove_cones(1)) {  // simpler parameters may need fewer cones
        }
        return std::move(smallest_);
    }

  private:
    bool keeps_differing(CrossCheckCase smaller) {
        if (trials_left_ == 0) return false;
        --trials_left_;
        if (!differs_(smaller)) return false;
        smallest_ = std::move(smaller);
        return true;
    }

    /// Tries to remove each run of so many cones. Returns whether one was removed.
    bool remove_cones(std::size_t together) {
        bool any = false;
        for (std::size_t first = 0; first < smallest_.scene.cones.size();) {
            CrossCheckCase smaller = smallest_;
            std::vector<Cone>& cones = smaller.scene.cones;
            const std::size_t count = std::min(together, cones.size() - first);
            const auto begin = cones.begin() + static_cast<std::ptrdiff_t>(first);
            cones.erase(begin, begin + static_cast<std::ptrdiff_t>(count));
            if (!cones.empty() && keeps_differing(std::move(smaller))) {
                any = true;
            } else {
                first += count;
            }
        }
        return any;
    }

    void reset_parameters() {
        const auto reset = [&](auto member) {
            if (smallest_.parameters.*member == RldParameters{}.*member) return;
            CrossCheckCase simpler = smallest_;
            simpler.parameters.*member = RldParameters{}.*member;
            (void)keeps_differing(std::move(simpler));
        };
        for (const auto& fields : {rld_extra_fields(), rld_parameter_fields()}) {
            for (const RldParameterField& field : fields) reset(field.value);
        }
        reset(&RldParameters::use_confidence);
        reset(&RldParameters::forbid_crossing);
        reset(&RldParameters::pairing);
        reset(&RldParameters::learned_costs);
    }

    CrossCheckCase smallest_;
    const std::function<bool(const CrossCheckCase&)>& differs_;
    std::size_t trials_left_;
};

namespace fs = std::filesystem;

constexpr std::array kFormulations{Formulation::paper, Formulation::tight};

void write_program(const fs::path& file, const CrossCheckCase& drawn) {
    const LaneGraphProblem problem =
        make_problem(drawn.scene, drawn.parameters, parts(drawn.formulation).extent);
    if (problem.edges.empty()) return;
    const LaneGraphModel model(problem, drawn.formulation);
    AtomicFile output(file);
    write_mps(output.stream(), model.program(), drawn.scene.id);
    output.commit();
}

}  // namespace

std::vector<std::string_view> cross_check_kinds() {
    std::vector<std::string_view> names;
    for (const Kind& kind : kKinds) names.push_back(kind.name);
    return names;
}

CrossCheckCase draw_cross_check_case(std::span<const AnnotatedScene> given, std::uint64_t seed,
                                     std::size_t number) {
    constexpr std::array kLimits_ms{0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0};
    const std::string name = fmt::format("cross-check {}", number);
    Draw draw(generator_of(name, seed));
    CrossCheckCase drawn;
    drawn.number = number;
    draw_parameters(drawn.parameters, draw);
    const std::size_t cones = cone_count(draw);
    if (!given.empty() && draw.chance(0.3)) {
        drawn.kind = "given";
        drawn.scene = nearest_ahead(given[draw.index(given.size())].scene, cones);
        if (drawn.scene.cones.empty()) add_cone(drawn.scene, 0.0, 0.0);
    } else {
        const Kind& kind = kKinds[draw.index(kKinds.size())];
        drawn.kind = kind.name;
        kind.make(drawn, draw, cones);
        draw_colors_and_confidences(drawn.scene, draw);
        shuffle(drawn.scene.cones, draw.generator());
    }
    drawn.scene.id = fmt::format("case_{}", number);
    drawn.tight_limit_ms = draw.one_of(kLimits_ms);
    // Learned costs depend on metres. They are not used in scenes that are scaled or so far away that metres
    // are lost, nor with an edge of length zero, which has no direction.
    constexpr std::array<std::string_view, 3> kWithout{"coincident", "far_away", "scaled"};
    if (draw.chance(0.2) && std::ranges::find(kWithout, drawn.kind) == kWithout.end())
        draw_learned_costs(drawn.parameters, draw);
    // The program of the paper formulation grows with the fourth power of the cones.
    if (drawn.scene.cones.size() <= 8 && draw.chance(0.3)) drawn.formulation = Formulation::paper;
    return drawn;
}

CrossCheckCase shrink(CrossCheckCase drawn, const std::function<bool(const CrossCheckCase&)>& differs,
                      std::size_t max_trials) {
    return Shrinking(std::move(drawn), differs, max_trials).run();
}

fs::path write_case(const fs::path& directory, const StoredCase& stored,
                    std::span<const std::string> findings) {
    const CrossCheckCase& drawn = stored.drawn;
    const std::string& name = drawn.scene.id;
    AnnotatedScene scene;
    scene.scene = drawn.scene;
    write_scenes(directory / (name + ".scenes.jsonl"), std::array{scene});
    write_rld_parameters(directory / (name + ".params.json"), drawn.parameters);
    write_program(directory / (name + ".mps"), drawn);
    nlohmann::ordered_json json{{"case", drawn.number},
                                {"kind", drawn.kind},
                                {"scenes", name + ".scenes.jsonl"},
                                {"params", name + ".params.json"},
                                {"formulation", to_string(drawn.formulation)},
                                {"solvers", stored.solvers},
                                {"time_limit_ms", stored.time_limit_ms},
                                {"tight_limit_ms", drawn.tight_limit_ms},
                                {"findings", findings}};
    fs::path file = directory / (name + ".case.json");
    AtomicFile output(file);
    output.stream() << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
    output.commit();
    return file;
}

StoredCase read_case(const fs::path& file) {
    StoredCase stored;
    with_json_file(file, [&](const JsonNode& json) {
        CrossCheckCase& drawn = stored.drawn;
        drawn.number = static_cast<std::size_t>(json.member("case").unsigned_integer());
        drawn.kind = json.member("kind").string();
        drawn.formulation = json.member("formulation").one_of(kFormulations);
        stored.time_limit_ms = json.member("time_limit_ms").non_negative_number();
        drawn.tight_limit_ms = json.member("tight_limit_ms").non_negative_number();
        const JsonNode solvers = json.member("solvers");
        for (std::size_t i = 0; i < solvers.array_size(); ++i)
            stored.solvers.push_back(solvers.element(i).string());
        if (stored.solvers.empty()) solvers.fail("must name one");
        drawn.scene = read_scenes(file.parent_path() / json.member("scenes").string()).front().scene;
        drawn.parameters = read_rld_parameters(file.parent_path() / json.member("params").string());
    });
    return stored;
}

}  // namespace conelane::experiments
