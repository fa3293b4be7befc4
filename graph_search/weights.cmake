# The weight files in weights/ as a C++ source file, by CMake alone. Numbers stay decimal text of 17 digits at most on
# their way, so the compiler reads the same doubles that a JSON parser reads.

# Sets `result` to the numbers of the JSON array, its rows if nested one behind the other, as an initialiser.
function(conelane_numbers result json)
    string(REGEX REPLACE "[][ \n]" "" numbers "${json}")
    set(${result} "{${numbers}}" PARENT_SCOPE)
endfunction()

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

# Sets `result` to the definition of a RankNetTable.
function(conelane_rank_net result symbol name)
    conelane_weight_file(json ${name})
    set(text "")
    foreach(key mean deviation hidden hidden_bias output)
        string(JSON values GET "${json}" ${key})
        conelane_numbers(numbers "${values}")
        string(APPEND text "constexpr double ${symbol}_${key}[]${numbers};\n")
    endforeach()
    string(JSON features GET "${json}" features)
    string(REGEX REPLACE "[][ \n]" "" features "${features}")
    string(APPEND text "constexpr std::string_view ${symbol}_features[]{${features}};\n")
    string(JSON output_bias GET "${json}" output_bias)
    string(APPEND text "constinit const RankNetTable ${symbol}{${symbol}_features, ${symbol}_mean, ${symbol}_deviation, "
                       "${symbol}_hidden, ${symbol}_hidden_bias, ${symbol}_output, ${output_bias}};\n")
    set(${result} "${text}" PARENT_SCOPE)
endfunction()

# Sets `result` to the definition of a span of StepScoreTable.
function(conelane_step_scores result symbol name)
    conelane_weight_file(json ${name})
    string(JSON count LENGTH "${json}" measures)
    math(EXPR last "${count} - 1")
    set(text "")
    set(tables "")
    foreach(i RANGE ${last})
        string(JSON measure MEMBER "${json}" measures ${i})
        string(JSON scores GET "${json}" measures ${measure} scores)
        string(JSON first GET "${json}" measures ${measure} first)
        string(JSON spacing GET "${json}" measures ${measure} spacing)
        conelane_numbers(numbers "${scores}")
        string(APPEND text "constexpr double ${symbol}_${measure}[]${numbers};\n")
        string(APPEND tables "    {\"${measure}\", ${first}, ${spacing}, ${symbol}_${measure}},\n")
    endforeach()
    string(APPEND text "constexpr StepScoreTable ${symbol}_tables[]{\n${tables}};\n"
                       "constinit const std::span<const StepScoreTable> ${symbol}{${symbol}_tables};\n")
    set(${result} "${text}" PARENT_SCOPE)
endfunction()

# Writes `output`, which defines what shipped_weight_tables.hpp declares.
function(conelane_weights output)
    conelane_rank_net(paper kPaperRankNet rank_net_paper)
    conelane_rank_net(extended kExtendedRankNet rank_net_extended)
    conelane_step_scores(steps kStepScores step_scores)
    file(CONFIGURE OUTPUT ${output} @ONLY CONTENT [[
#include "graph_search/shipped_weight_tables.hpp"

namespace conelane {

@paper@
@extended@
@steps@
}  // namespace conelane
]])
endfunction()
