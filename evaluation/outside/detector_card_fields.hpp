#pragma once

#include "evaluation/formats/json_records.hpp"
#include "evaluation/outside/outside_detector.hpp"

namespace conelane {

template <>
inline constexpr std::tuple kFields<DetectorCard>{Field{"name", &DetectorCard::name},
                                                  Field{"address", &DetectorCard::address},
                                                  Field{"licence", &DetectorCard::licence},
                                                  Field{"colour_used", &DetectorCard::color_used},
                                                  Field{"history_used", &DetectorCard::history_used},
                                                  Field{"training_courses", &DetectorCard::training_courses}};

}  // namespace conelane
