# The weight files in weights/ as a C++ source file, by CMake alone. The digits are cut out of the text: CMake may print
# a number that it parsed with fewer of them. So the compiler reads the doubles that a JSON parser reads. The files are
# laid out as `conelane train` writes them, a line for each key; any other layout is an error.

# Sets `result` to the JSON text of weights/NAME.json, after a check of its version.
function(conelane_weight_file result name)
    set(file ${CMAKE_CURRENT_SOURCE_DIR}/weights/${name}.json)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(READ ${file} json)
    string(JSON version GET "${json}" version)
    if(NOT version STREQUAL "1")
        message(FATAL_ERROR "${file} has version ${version}, expected 1")
    endif()
    set(${result} "${json}" PARENT_SCOPE)
endfunction()

# Sets `result` to what `pattern` matches in its first group.
function(conelane_cut result text pattern)
    if(NOT text MATCHES "${pattern}")
        message(FATAL_ERROR "the weight files have nothing like ${pattern}")
    endif()
    set(${result} "${CMAKE_MATCH_1}" PARENT_SCOPE)
endfunction()

# Sets `result` to the definition of a RankNetTable. The rows of `hidden` stand one behind the other.
function(conelane_rank_net result symbol name)
    conelane_weight_file(json ${name})
    set(text "")
    foreach(key mean deviation hidden_bias output)
        conelane_cut(numbers "${json}" "\n\"${key}\": *\\[([^]]*)\\]")
        string(APPEND text "constexpr double ${symbol}_${key}[]{${numbers}};\n")
    endforeach()
    conelane_cut(numbers "${json}" "\n\"hidden\": *(\\[.*\\]),\n\"hidden_bias\"")
    string(REGEX REPLACE "[][ \n]" "" numbers "${numbers}")
    string(APPEND text "constexpr double ${symbol}_hidden[]{${numbers}};\n")
    conelane_cut(features "${json}" "\n\"features\": *\\[([^]]*)\\]")
    string(APPEND text "constexpr std::string_view ${symbol}_features[]{${features}};\n")
    conelane_cut(output_bias "${json}" "\n\"output_bias\": *([-+.0-9eE]+)")
    string(APPEND text "constinit const RankNetTable ${symbol}{${symbol}_features, ${symbol}_mean, ${symbol}_deviation, "
                       "${symbol}_hidden, ${symbol}_hidden_bias, ${symbol}_output, ${output_bias}};\n")
    set(${result} "${text}" PARENT_SCOPE)
endfunction()

# Sets `result` to the definition of a span of StepScoreTable.
function(conelane_step_scores result symbol name)
    conelane_weight_file(json ${name})
    string(JSON count LENGTH "${json}" measures)
    math(EXPR last "${count} - 1")
    conelane_cut(measures "${json}" "\n\"measures\": *{(.*)}")
    set(text "")
    set(tables "")
    foreach(i RANGE ${last})
        string(JSON measure MEMBER "${json}" measures ${i})
        conelane_cut(table "${measures}" "\"${measure}\": *{([^}]*)}")
        conelane_cut(first "${table}" "\"first\": *([-+.0-9eE]+)")
        conelane_cut(spacing "${table}" "\"spacing\": *([-+.0-9eE]+)")
        conelane_cut(scores "${table}" "\"scores\": *\\[([^]]*)\\]")
        string(APPEND text "constexpr double ${symbol}_${measure}[]{${scores}};\n")
        string(APPEND tables "    {\"${measure}\", ${first}, ${spacing}, ${symbol}_${measure}},\n")
    endforeach()
    string(APPEND text "constexpr StepScoreTable ${symbol}_tables[]{\n${tables}};\n"
                       "constinit const std::span<const StepScoreTable> ${symbol}{${symbol}_tables};\n")
    set(${result} "${text}" PARENT_SCOPE)
endfunction()

# Sets `result` to the definition of a FrontTable.
function(conelane_front_weights result symbol name)
    conelane_weight_file(json ${name})
    conelane_cut(features "${json}" "\n\"features\": *{([^}]*)}")
    string(REGEX REPLACE "\"(state|extend|stop|start|cone|lane)\": *\\[" "" features "${features}")
    string(REPLACE "]" "" features "${features}")
    set(text "constexpr std::string_view ${symbol}_features[]{${features}};\n")
    set(networks "")
    foreach(network extend stop start rank usable right)
        set(spans "")
        foreach(key hidden hidden_bias output linear output_bias)
            conelane_cut(numbers "${json}" "\n\"${network}_${key}\": *\\[([^]]*)\\]")
            string(APPEND text "constexpr double ${symbol}_${network}_${key}[]{${numbers}};\n")
            string(APPEND spans "${symbol}_${network}_${key}, ")
        endforeach()
        string(APPEND networks ",\n    {${spans}}")
    endforeach()
    conelane_cut(least_trust "${json}" "\n\"least_trust\": *([-+.0-9eE]+)")
    string(APPEND text "constinit const FrontTable ${symbol}{${symbol}_features${networks}, ${least_trust}};\n")
    set(${result} "${text}" PARENT_SCOPE)
endfunction()

# Writes `output`, which defines what shipped_weight_tables.hpp declares.
function(conelane_weights output)
    conelane_rank_net(paper kPaperRankNet rank_net_paper)
    conelane_rank_net(extended kExtendedRankNet rank_net_extended)
    conelane_step_scores(steps kStepScores step_scores)
    conelane_front_weights(front kFront front)
    file(CONFIGURE OUTPUT ${output} @ONLY CONTENT [[
#include "graph_search/weights/shipped_weight_tables.hpp"

namespace conelane {

@paper@
@extended@
@steps@
@front@
}  // namespace conelane
]])
endfunction()
