# check_sources(CHECK FOLDER...): CHECK(FOLDER FILE) for each .hpp and .cpp file below the folders of ROOT, FILE as seen from
# ROOT. That there is none is an error.
function(check_sources check)
    foreach(folder IN LISTS ARGN)
        file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/${folder}/*.hpp ${ROOT}/${folder}/*.cpp)
        list(FILTER files EXCLUDE REGEX "^tests/consumer/") # a project of its own
        foreach(file IN LISTS files)
            math(EXPR checked "${checked} + 1")
            cmake_language(CALL ${check} ${folder} ${file})
        endforeach()
    endforeach()
    if(NOT checked)
        message(FATAL_ERROR "no sources below ${ROOT}")
    endif()
    message(STATUS "${checked} files checked")
endfunction()
