# How a build of conelane finds its libraries, and how the installed package finds them again: a static library leaves
# its dependencies to whoever links it.

# `conelane_require_modules(NAME MODULES...)`: pkg-config modules as target PkgConfig::NAME.
macro(conelane_require_modules name)
    find_package(PkgConfig REQUIRED)
    pkg_check_modules(${name} REQUIRED QUIET IMPORTED_TARGET GLOBAL ${ARGN})
endmacro()

# `conelane_require_library(NAME HEADER)`: a library without package or pkg-config file, as target conelane_external_NAME.
function(conelane_require_library name header)
    if(TARGET conelane_external_${name})
        return()
    endif()
    find_library(CONELANE_${name}_LIBRARY ${name} REQUIRED)
    find_path(CONELANE_${name}_INCLUDE_DIR ${header} PATH_SUFFIXES ${name} REQUIRED)
    mark_as_advanced(CONELANE_${name}_LIBRARY CONELANE_${name}_INCLUDE_DIR)
    add_library(conelane_external_${name} UNKNOWN IMPORTED GLOBAL)
    set_target_properties(conelane_external_${name} PROPERTIES
        IMPORTED_LOCATION ${CONELANE_${name}_LIBRARY}
        INTERFACE_INCLUDE_DIRECTORIES ${CONELANE_${name}_INCLUDE_DIR})
endfunction()
