# cmake -D ROOT=DIR -P words.cmake: no file below ROOT, but those that git ignores, names a path of one machine or
# leaves work open. The brackets keep the patterns from finding themselves.
cmake_minimum_required(VERSION 3.22...3.25)

set(machine_path "(^|[^A-Za-z0-9_.}-])/(work|home|root|tmp|farm|Users)/[A-Za-z]")
set(open_work "TO[D]O|FIX[M]E")
execute_process(
    COMMAND ${CMAKE_COMMAND} -E env GIT_CEILING_DIRECTORIES=${ROOT}/.. # a repository around ROOT does not matter
            git grep --no-index --exclude-standard --line-number -I -E -e ${machine_path} -e ${open_work} -- .
    WORKING_DIRECTORY ${ROOT} OUTPUT_VARIABLE found ERROR_VARIABLE error RESULT_VARIABLE result)
if(result EQUAL 0)
    message(FATAL_ERROR "these lines name a path of one machine or leave work open:\n${found}")
elseif(NOT result EQUAL 1) # 1: git grep found nothing
    message(FATAL_ERROR "git grep: ${result} ${error}")
endif()
