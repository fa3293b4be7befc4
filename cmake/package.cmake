# The libraries of this project: how each is made, and how they are installed as the package `conelane` with a core and
# the components milp and relaxations. `find_package(conelane COMPONENTS milp)`; without components, the core alone.
include(CMakePackageConfigHelpers)
include(${CMAKE_CURRENT_LIST_DIR}/dependencies.cmake)

# Finds, for a component, pkg-config modules (see conelane_require_modules) or a library (conelane_require_library); the
# installed package does the same again.
macro(conelane_find_modules component name)
    conelane_require_modules(${name} ${ARGN})
    string(JOIN " " conelane_arguments ${name} ${ARGN})
    set_property(GLOBAL APPEND_STRING PROPERTY CONELANE_${component}_DEPENDENCIES
                                               "conelane_require_modules(${conelane_arguments})\n")
endmacro()
macro(conelane_find_library component name header)
    conelane_require_library(${name} ${header})
    set_property(GLOBAL APPEND_STRING PROPERTY CONELANE_${component}_DEPENDENCIES
                                               "conelane_require_library(${name} ${header})\n")
endmacro()

# What all code of this project is compiled with. Internal headers are included as FOLDER/FILE from the top, a path that
# no user sees. Contraction to fused multiply-add would make results differ between processors. GCC 12 sees an overlap
# (-Wrestrict) in every inlined concatenation of strings (its bug 105651).
function(conelane_compile_options target)
    set_target_properties(${target} PROPERTIES CXX_STANDARD 20 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF)
    target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
    if(MSVC)
        target_compile_options(${target} PRIVATE /W4 /permissive- /utf-8 /fp:precise
                                                 $<$<BOOL:${CONELANE_WARNINGS_AS_ERRORS}>:/WX>)
        target_compile_definitions(${target} PRIVATE _USE_MATH_DEFINES NOMINMAX)
    elseif(CMAKE_CXX_COMPILER_ID MATCHES "^(GNU|Clang|AppleClang)$")
        target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                                                 -ffp-contract=off
                                                 $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
                                                 $<$<BOOL:${CONELANE_WARNINGS_AS_ERRORS}>:-Werror>)
    endif()
endfunction()

# In release builds, -O3 is for the core. What waits for files and for the core compiles in half the time at LEVEL and with
# precompiled headers: those of a target are what takes it longest to read. At -O1 GCC 12 also sees array bounds broken in
# inlined concatenations of strings.
function(conelane_compile_quickly target level)
    target_compile_options(${target} PRIVATE $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU,Clang,AppleClang>>:-O${level}>
                                             $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>)
    if(ARGN)
        target_precompile_headers(${target} PRIVATE ${ARGN})
    endif()
endfunction()

# `conelane_precompile(TARGET)`: what nearly every file of the core includes, compiled once for all of them. With precompiled
# headers GCC 12 sees bounds broken in inlined concatenations of strings: .ci/compilers does without, and has these warnings.
function(conelane_precompile target)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
        target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overread -Wno-stringop-overflow)
    endif()
    if(target STREQUAL conelane_model)
        target_precompile_headers(${target} PRIVATE
            <algorithm> <array> <cmath> <cstddef> <cstdint> <functional> <limits> <map> <memory> <numbers>
            <optional> <span> <string> <string_view> <tuple> <utility> <vector>)
    else()
        target_precompile_headers(${target} REUSE_FROM conelane_model)
    endif()
endfunction()

# `conelane_join_files(TARGET GROUP FILES...)`: with CONELANE_JOIN_FILES, these files are compiled as one. Functions that CLI11,
# nlohmann-json and fmt define in headers take most of the time, and are then compiled once a group. Files of a group must not
# share names in unnamed namespaces. Without it, as in the presets without precompiled headers, a missing include shows.
function(conelane_join_files target group)
    if(CONELANE_JOIN_FILES)
        set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
        set_source_files_properties(${ARGN} PROPERTIES UNITY_GROUP ${group})
    endif()
endfunction()

# `conelane_embed(SOURCE HEADER [NAME FILE]... [LOOKUP FUNCTION FILE...])`: makes the source file SOURCE of the build, which
# defines each std::string_view NAME that HEADER declares as the bytes of FILE, and FUNCTION, which HEADER declares too: the bytes
# of a file by its name without ending. Nothing is read from them here: the library parses its own files.
function(conelane_embed source header)
    cmake_parse_arguments(ARG "" "" "LOOKUP" ${ARGN})
    set(named ${ARG_UNPARSED_ARGUMENTS})
    if(ARG_LOOKUP)
        list(POP_FRONT ARG_LOOKUP lookup)
    endif()
    set(definitions "")
    set(cases "")
    foreach(file IN LISTS ARG_LOOKUP)
        string(MAKE_C_IDENTIFIER k_${file} name)
        list(APPEND named ${name} ${file})
        cmake_path(GET file STEM LAST_ONLY stem)
        string(APPEND cases "    if (name == \"${stem}\") return ${name};\n")
    endforeach()
    while(named)
        list(POP_FRONT named name file)
        set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${file})
        file(READ ${file} bytes HEX) # as numbers: compilers need not take strings of more than 65 536 characters
        string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
        string(APPEND definitions "constexpr char ${name}_bytes[]{${bytes}};\n"
                                  "constinit const std::string_view ${name}{${name}_bytes, sizeof ${name}_bytes};\n")
    endwhile()
    if(cases)
        string(APPEND definitions "\nstd::string_view ${lookup}(std::string_view name) {\n${cases}    return {};\n}\n")
    endif()
    file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${source} @ONLY CONTENT [[
#include "@header@"

namespace conelane {

@definitions@
}  // namespace conelane
]])
endfunction()

# The headers that users see are in a folder include/conelane beside the sources.
# `conelane_library(NAME [COMPONENT C] SOURCES... PUBLIC LIBRARIES... PRIVATE LIBRARIES...)`: target conelane_NAME, for
# users conelane::NAME. Without a component it is not installed.
function(conelane_library name)
    cmake_parse_arguments(ARG "" "COMPONENT" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
    set(target conelane_${name})
    add_library(${target} STATIC ${ARG_SOURCES})
    add_library(conelane::${name} ALIAS ${target})
    set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
    target_compile_features(${target} PUBLIC cxx_std_20)
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/include)
        target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                                    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    endif()
    target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
    conelane_compile_options(${target})
    if(CONELANE_FUZZING)
        target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link) # says which branches an input took
    endif()
    if(ARG_COMPONENT)
        install(TARGETS ${target} EXPORT conelane_${ARG_COMPONENT})
        if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/include)
            install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
        endif()
        set_property(GLOBAL APPEND PROPERTY CONELANE_COMPONENTS ${ARG_COMPONENT})
    endif()
endfunction()

# Installs what conelane_library has collected, once all of them are there.
function(conelane_install_package)
    set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/conelane)
    get_property(components GLOBAL PROPERTY CONELANE_COMPONENTS)
    list(REMOVE_DUPLICATES components)
    foreach(component IN LISTS components)
        get_property(dependencies GLOBAL PROPERTY CONELANE_${component}_DEPENDENCIES)
        install(EXPORT conelane_${component} NAMESPACE conelane:: DESTINATION ${package_dir})
        file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/conelane_${component}_dependencies.cmake @ONLY
             CONTENT "@dependencies@")
        install(FILES ${PROJECT_BINARY_DIR}/conelane_${component}_dependencies.cmake DESTINATION ${package_dir})
    endforeach()
    write_basic_package_version_file(${PROJECT_BINARY_DIR}/conelaneConfigVersion.cmake COMPATIBILITY SameMinorVersion)
    install(FILES ${PROJECT_SOURCE_DIR}/cmake/conelaneConfig.cmake ${PROJECT_SOURCE_DIR}/cmake/dependencies.cmake
                  ${PROJECT_BINARY_DIR}/conelaneConfigVersion.cmake
            DESTINATION ${package_dir})
endfunction()
