# cmake -D SCRATCH=DIR -P violations.cmake: the other checks let pass what is right and find what is not.
cmake_minimum_required(VERSION 3.22...3.25)

if(NOT SCRATCH)
    message(FATAL_ERROR "-D SCRATCH=DIR is missing: the folder is emptied and written to")
endif()

# Runs a check on a tree of two files, model/scene.hpp and FILE with the line CONTENT, and a third, the header `also`,
# where that is set. It must fail with a message that matches COMPLAINT, or pass where that is empty.
function(expect complaint check file content)
    file(REMOVE_RECURSE ${SCRATCH})
    file(WRITE ${SCRATCH}/model/scene.hpp "#pragma once\n#include <vector>\n")
    if(also)
        file(WRITE ${SCRATCH}/${also} "#pragma once\n")
    endif()
    file(WRITE ${SCRATCH}/${file} "${content}\n")
    execute_process(COMMAND ${CMAKE_COMMAND} -D ROOT=${SCRATCH} -P ${CMAKE_CURRENT_LIST_DIR}/${check}.cmake
                    RESULT_VARIABLE result ERROR_VARIABLE error OUTPUT_QUIET)
    string(REGEX REPLACE "[ \n]+" " " error "${error}") # CMake breaks its messages into lines
    if(complaint STREQUAL "" AND NOT result EQUAL 0)
        message(SEND_ERROR "${file} with ${content}: must pass, yet: ${error}")
    elseif(NOT complaint STREQUAL "" AND (result EQUAL 0 OR NOT error MATCHES "${complaint}"))
        message(SEND_ERROR "${file} with ${content}: must fail with '${complaint}', yet: ${error}")
    endif()
endfunction()

expect("" includes solvers/a.cpp "#include \"model/scene.hpp\"")
expect("" includes tests/a.cpp "#include \"model/scene.hpp\"")
expect("model/a.hpp has no #pragma once" includes model/a.hpp "#include <vector>")
foreach(direction IN ITEMS "model;solvers" "model;graph_search" "model;experiments" "solvers;graph_search"
                           "graph_search;solvers" "solvers;detectors" "graph_search;detectors"
                           "detectors;evaluation" "solvers;evaluation" "graph_search;evaluation" "evaluation;experiments"
                           "experiments;program" "evaluation;program" "learning;experiments" "evaluation;learning" "python;experiments" "experiments;tests"
                           "experiments;python" "detectors;python" "python;tests"
                           "evaluation;playground" "playground;experiments" "playground;python")
    list(GET direction 0 from)
    list(GET direction 1 to)
    expect("${from}/a.hpp may not include ${to}/b.hpp" includes ${from}/a.hpp "#pragma once\n#include \"${to}/b.hpp\"")
endforeach()

# Layers: a second file to include, since one that is missing is a fault of its own.
file(REMOVE_RECURSE ${SCRATCH})
foreach(direction IN ITEMS "evaluation/world/track;evaluation/formats/scene" "evaluation/world/scene;evaluation/formats/text"
                           "evaluation/seeded_random;evaluation/formats/text" "experiments/methods/method;experiments/studies/study" "learning/training/learner;learning/tuning/tuner"
                           "program/commands/command;program/main"
                           "solvers/path_pair/bound/multipliers;solvers/path_pair/search/branch_and_bound"
                           "solvers/path_pair/primal/incumbent;solvers/path_pair/frontier/graph")
    list(GET direction 0 lower)
    list(GET direction 1 upper)
    set(also ${upper}.hpp)
    expect("${lower}.cpp may not include ${upper}.hpp, which is of a later" includes ${lower}.cpp "#include \"${upper}.hpp\"")
    set(also ${lower}.hpp)
    expect("" includes ${upper}.cpp "#include \"${lower}.hpp\"")
endforeach()
set(also evaluation/formats/text.hpp)
expect("" includes evaluation/formats/more.cpp "#include \"evaluation/formats/text.hpp\"")
set(also)
expect("experiments/new/a.cpp has no place in layers_of_experiments" includes experiments/new/a.cpp "")

expect("solvers/a.cpp may not include scene.hpp" includes solvers/a.cpp "#include \"scene.hpp\"")
expect("may not include ../model/scene.hpp" includes solvers/a.cpp "#include \"../model/scene.hpp\"")
expect("no FOLDER/FILE" includes solvers/a.cpp "#include \"solvers/../model/scene.hpp\"")
expect("no FOLDER/FILE" includes solvers/a.cpp "#include \"model/nothing.hpp\"")

# Public headers.
set(also model/include/conelane/lane.hpp)
expect("" includes solvers/a.cpp "#include \"conelane/lane.hpp\"")
expect("" includes model/lane.cpp "#include \"conelane/lane.hpp\"\n#include <cmath>")
expect("model/lane.cpp does not include conelane/lane.hpp first" includes model/lane.cpp
       "#include <cmath>\n#include \"conelane/lane.hpp\"")
expect("which is no public header" includes solvers/a.cpp "#include \"conelane/nothing.hpp\"")
expect("is public and may not include model/scene.hpp" includes solvers/include/conelane/a.hpp
       "#pragma once\n#include \"model/scene.hpp\"")
set(also detectors/include/conelane/lane.hpp)
expect("solvers/a.cpp may not include conelane/lane.hpp" includes solvers/a.cpp "#include \"conelane/lane.hpp\"")
set(also)

expect("" includes solvers/a.cpp "#include <CbcModel.hpp>\n#include <boost/geometry.hpp>")
expect("" includes solvers/detail/a.hpp "#pragma once\n#include <CbcModel.hpp>")
expect("solvers/a.hpp includes <Cbc...>, which" includes solvers/a.hpp "#pragma once\n#include <CbcModel.hpp>")
expect("solvers/a.hpp includes <IpT...>, which" includes solvers/a.hpp "#pragma once\n#include <IpTNLP.hpp>")
expect("includes <boost/...>, which" includes graph_search/a.hpp "#pragma once\n#  include <boost/geometry.hpp>")
expect("" includes evaluation/formats/a.hpp "#pragma once\n#include <nlohmann/json.hpp>")

expect("" includes model/scene.cpp "#include \"model/scene.hpp\"\n#include <cmath>")
expect("model/scene.cpp does not include model/scene.hpp first" includes model/scene.cpp
       "#include <cmath>\n#include \"model/scene.hpp\"")

set(now "const auto now = std::chrono::")
expect("" clocks model/deadline.hpp "${now}steady_clock::now()")
expect("solvers/a.cpp has a clock of its own" clocks solvers/a.cpp "${now}steady_clock::now()")
expect("model/deadline.hpp looks at a clock that may jump" clocks model/deadline.hpp "${now}system_clock::now()")
foreach(clock IN ITEMS "std::chrono::high_resolution_clock::now()" "gettimeofday(&now, nullptr)" "std::time(nullptr)"
                       "clock_gettime(CLOCK_REALTIME, &now)" "seed = time(nullptr)")
    expect("detectors/a.cpp looks at a clock that may jump" clocks detectors/a.cpp "${clock}")
endforeach()
expect("" clocks detectors/a.cpp "deadline_for(time) + remaining_time(0)")

set(home home) # put together here, so that this file itself passes
set(later DO)
expect("" words model/a.cpp "// https://example.org/${home}/page, build/tmp/file, To do, \"\${dir}/tmp/x\"")
expect("model/a.cpp:1:// see /${home}/me/file" words model/a.cpp "// see /${home}/me/file")
expect("model/a.cpp:1:// TO${later}" words model/a.cpp "// TO${later} later")
