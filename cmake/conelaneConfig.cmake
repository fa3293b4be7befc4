# The package `conelane`: the core (conelane::detectors) and, where they are asked for and were installed, the components
# milp (conelane::milp) and relaxations (conelane::relaxations).
include(CMakeFindDependencyMacro)
include(${CMAKE_CURRENT_LIST_DIR}/dependencies.cmake)
find_dependency(Eigen3 3.3 NO_MODULE)

set(conelane_components core)
if("relaxations" IN_LIST conelane_FIND_COMPONENTS)
    list(APPEND conelane_components milp) # what it stands on
endif()
list(APPEND conelane_components ${conelane_FIND_COMPONENTS})
list(REMOVE_ITEM conelane_components detectors) # another name of the core
list(REMOVE_DUPLICATES conelane_components)
foreach(conelane_component IN LISTS conelane_components)
    if(EXISTS ${CMAKE_CURRENT_LIST_DIR}/conelane_${conelane_component}.cmake)
        include(${CMAKE_CURRENT_LIST_DIR}/conelane_${conelane_component}_dependencies.cmake)
        include(${CMAKE_CURRENT_LIST_DIR}/conelane_${conelane_component}.cmake)
    elseif(conelane_FIND_REQUIRED_${conelane_component} OR NOT DEFINED conelane_FIND_REQUIRED_${conelane_component})
        set(conelane_FOUND FALSE)
        set(conelane_NOT_FOUND_MESSAGE "conelane was installed without the component ${conelane_component}")
        return()
    endif()
endforeach()
