# cmake -D ROOT=DIR -P includes.cmake: checks the #include lines of the sources below ROOT.
# - Quoted includes name folder and file, and the folder is one that the including folder may depend on. A public header
#   is "conelane/FILE", of the folder that has it below include/; it includes public headers only.
# - Inside experiments/ a folder includes only itself and those before it in experiments_layers.
# - Headers of the installed libraries include no solver, Boost, parser or thread library: those stay in .cpp files,
#   or in a header below a folder `detail`, which is private to its library.
# - x.cpp includes x.hpp first, so compiling it shows that the header includes what it needs.
# - Headers guard themselves by #pragma once.
cmake_minimum_required(VERSION 3.22...3.25)
include(${CMAKE_CURRENT_LIST_DIR}/sources.cmake)

set(model_depends_on model)
set(solvers_depends_on model solvers)
set(graph_search_depends_on model graph_search)
set(detectors_depends_on model solvers graph_search detectors)
set(experiments_depends_on model solvers graph_search detectors experiments)
set(python_depends_on model solvers graph_search detectors experiments python)
set(tests_depends_on model solvers graph_search detectors experiments tests)
# From tracks to tables, each folder and each file of experiments/ itself, without its ending: what stands later may
# include what stands before.
set(experiments_layers provenance progress seeded_random files tracks training_courses scenes scoring methods outside options comparison
                       checking cross_check training tuning cross_validation instances studies report commands conelane benchmarks examples)
set(private_libraries
    "coin/|Cbc|Cgl|Clp|Coin|Osi|Ip[A-Z]|nlopt|glpk|boost/|zlib|nlohmann/|yaml-cpp/|CLI/|tbb/|oneapi/")

# The folder of each public header.
file(GLOB_RECURSE public_headers RELATIVE ${ROOT} ${ROOT}/*/include/conelane/*.hpp ${ROOT}/*/*/include/conelane/*.hpp)
foreach(header IN LISTS public_headers)
    string(REGEX REPLACE "^([^/]+)/.*/([^/]+)$" "\\1;\\2" parts ${header})
    list(GET parts 1 name)
    list(GET parts 0 folder_of_${name})
endforeach()

# The place of a file in experiments_layers, counted from 0; -1 where it has none.
function(find_layer result file)
    string(REGEX REPLACE "^experiments/([^/.]+).*$" "\\1" name ${file})
    list(FIND experiments_layers "${name}" place)
    set(${result} ${place} PARENT_SCOPE)
endfunction()

function(check_includes folder file)
    file(STRINGS ${ROOT}/${file} lines REGEX "^[ \t]*#[ \t]*include")
    string(REGEX REPLACE "[.]cpp$" ".hpp" own_header ${file})
    get_filename_component(own_name ${own_header} NAME)
    if(folder_of_${own_name} STREQUAL folder AND NOT EXISTS ${ROOT}/${own_header})
        set(own_header conelane/${own_name})
    endif()
    if(file STREQUAL own_header)
        file(STRINGS ${ROOT}/${file} guard REGEX "^#pragma once$")
        if(NOT guard)
            message(SEND_ERROR "${file} has no #pragma once")
        endif()
    elseif((EXISTS ${ROOT}/${own_header} OR own_header MATCHES "^conelane/") AND NOT lines MATCHES "^#include \"${own_header}\"")
        message(SEND_ERROR "${file} does not include ${own_header} first")
    endif()
    if(folder STREQUAL "experiments")
        find_layer(layer ${file})
        if(layer EQUAL -1)
            message(SEND_ERROR "${file} has no place in experiments_layers")
        endif()
    endif()
    foreach(line IN LISTS lines)
        if(line MATCHES "\"([^\"]*)\"")
            set(included ${CMAKE_MATCH_1})
            string(REGEX MATCH "^[^/]*" included_folder ${included})
            if(file MATCHES "/include/conelane/" AND NOT included_folder STREQUAL "conelane")
                message(SEND_ERROR "${file} is public and may not include ${included}")
            endif()
            if(included MATCHES "^conelane/([^/]+)$")
                set(included_folder ${folder_of_${CMAKE_MATCH_1}})
                if(NOT included_folder)
                    message(SEND_ERROR "${file} includes ${included}, which is no public header")
                    continue()
                endif()
                if(included_folder IN_LIST ${folder}_depends_on)
                    continue()
                endif()
            endif()
            if(NOT included_folder IN_LIST ${folder}_depends_on)
                message(SEND_ERROR "${file} may not include ${included}")
            elseif(NOT EXISTS ${ROOT}/${included} OR included MATCHES "[.][.]/")
                message(SEND_ERROR "${file} includes ${included}, which is no FOLDER/FILE")
            elseif(folder STREQUAL "experiments" AND included_folder STREQUAL "experiments")
                find_layer(included_layer ${included})
                if(included_layer GREATER layer)
                    message(SEND_ERROR "${file} may not include ${included}, which is of a later layer")
                endif()
            endif()
        elseif(file MATCHES "^(model|solvers|graph_search|detectors)/.*[.]hpp$" AND NOT file MATCHES "/detail/"
               AND line MATCHES "<(${private_libraries})")
            message(SEND_ERROR "${file} includes <${CMAKE_MATCH_1}...>, which belongs in .cpp files")
        endif()
    endforeach()
endfunction()
check_sources(check_includes model solvers graph_search detectors experiments python tests)
