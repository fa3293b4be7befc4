# cmake -D ROOT=DIR -P clocks.cmake: the installed libraries look at the steady clock only, which nobody sets, and at one
# place: model/deadline.hpp. tests/clock_test.cpp shows it of calls.
cmake_minimum_required(VERSION 3.22...3.25)
include(${CMAKE_CURRENT_LIST_DIR}/sources.cmake)

set(time_of_day "system_clock|high_resolution_clock|utc_clock|gettimeofday|clock_gettime|CLOCK_REALTIME|[^a-z_]ftime *[(]|std::time *[(]|[^a-zA-Z_.:>]time *[(] *(0|NULL|nullptr)")

function(check_clocks folder file)
    file(STRINGS ${ROOT}/${file} lines REGEX "${time_of_day}|steady_clock")
    foreach(line IN LISTS lines)
        if(line MATCHES "${time_of_day}")
            message(SEND_ERROR "${file} looks at a clock that may jump: ${line}")
        elseif(NOT file STREQUAL "model/deadline.hpp")
            message(SEND_ERROR "${file} has a clock of its own, instead of model/deadline.hpp: ${line}")
        endif()
    endforeach()
endfunction()
check_sources(check_clocks model solvers graph_search detectors)
