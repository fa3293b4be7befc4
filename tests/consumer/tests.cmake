# What others do with this project, each way in a folder of its own: the core by FetchContent and by add_subdirectory,
# installed from there, and found as a package where pkg-config is out of reach, so no COIN library can be found; all
# components, found where this build was installed. GCC and Clang take turns where both are there.
set(consumer ${CMAKE_CURRENT_BINARY_DIR}/consumer)
add_test(NAME consumer.clean COMMAND ${CMAKE_COMMAND} -E rm -rf ${consumer})
set_tests_properties(consumer.clean PROPERTIES FIXTURES_SETUP consumer_clean)

find_program(CONELANE_GCC g++)
find_program(CONELANE_CLANG NAMES clang++-16 clang++)
set(consumer_output "1 3 5 [|] 2 4 6 straight\n1 3 5 [|] 2 4 6 straight\n1 3 5 [|] 2 4 6 straight\nfollowing 0")

# `consumer_test(NAME COMPILER NEEDED FIXTURE ARGUMENTS...)`
function(consumer_test name compiler needed)
    add_test(NAME consumer.${name}
             COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${CMAKE_CURRENT_LIST_DIR} ${consumer}/${name}
                     --build-generator ${CMAKE_GENERATOR} --build-options -D CMAKE_CXX_COMPILER=${compiler}
                     -D CMAKE_CXX_FLAGS=${CMAKE_CXX_FLAGS} ${ARGN} --test-command consumer)
    set_tests_properties(consumer.${name} PROPERTIES FIXTURES_REQUIRED ${needed} FIXTURES_SETUP consumer_${name}
                                                     PASS_REGULAR_EXPRESSION ${consumer_output})
endfunction()
set(without_pkg_config -D CMAKE_DISABLE_FIND_PACKAGE_PkgConfig=ON)

foreach(way IN ITEMS "fetch;${CONELANE_GCC}" "subdirectory;${CONELANE_CLANG}")
    list(GET way 0 by)
    list(GET way 1 compiler)
    if(NOT compiler)
        set(compiler ${CMAKE_CXX_COMPILER})
    endif()
    consumer_test(${by} ${compiler} consumer_clean -D CONELANE_BY=${by} -D CONELANE_SOURCES=${PROJECT_SOURCE_DIR}
                  ${without_pkg_config} -D CMAKE_INSTALL_PREFIX=${consumer}/${by}_prefix)
    set_tests_properties(consumer.${by} PROPERTIES TIMEOUT 900)
    add_test(NAME consumer.${by}_install COMMAND ${CMAKE_COMMAND} --install ${consumer}/${by})
    set_tests_properties(consumer.${by}_install PROPERTIES FIXTURES_REQUIRED consumer_${by}
                                                           FIXTURES_SETUP consumer_${by}_prefix)
    consumer_test(package_of_${by} ${compiler} consumer_${by}_prefix -D conelane_ROOT=${consumer}/${by}_prefix
                  ${without_pkg_config})
endforeach()

# The core of a project that stands alone, where no library but Eigen can be found: the Python package is skipped, and
# CMake says why. `-D CONELANE_PYTHON=ON` asks for what is missing.
set(without_libraries "")
foreach(library IN ITEMS Boost nlohmann_json yaml-cpp fmt TBB CLI11 ZLIB GTest PkgConfig Threads)
    list(APPEND without_libraries -D CMAKE_DISABLE_FIND_PACKAGE_${library}=ON)
endforeach()
set(core_alone ${CMAKE_COMMAND} -S ${PROJECT_SOURCE_DIR} -G ${CMAKE_GENERATOR} -D CMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
               -D CONELANE_BUILD_EXPERIMENTS=OFF -D BUILD_TESTING=OFF ${without_libraries})
add_test(NAME consumer.core_needs_eigen_alone COMMAND ${core_alone} -B ${consumer}/core_alone)
set_tests_properties(consumer.core_needs_eigen_alone PROPERTIES FIXTURES_REQUIRED consumer_clean
                     PASS_REGULAR_EXPRESSION "Python package is skipped.*Build files have been written"
                     FAIL_REGULAR_EXPRESSION "CMake Error")
# The package is asked for where Python's own needs are there, so Boost is what is missing first.
if(conelane_python)
    add_test(NAME consumer.python_names_what_it_needs
             COMMAND ${core_alone} -B ${consumer}/python_alone -D CONELANE_PYTHON=ON)
    set_tests_properties(consumer.python_names_what_it_needs PROPERTIES FIXTURES_REQUIRED consumer_clean
                         PASS_REGULAR_EXPRESSION "Boost")
endif()

add_test(NAME consumer.install COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR} --prefix ${consumer}/prefix)
set_tests_properties(consumer.install PROPERTIES FIXTURES_REQUIRED consumer_clean FIXTURES_SETUP consumer_prefix)
consumer_test(components ${CMAKE_CXX_COMPILER} consumer_prefix -D conelane_ROOT=${consumer}/prefix
              -D CONELANE_COMPONENTS=ON)
add_test(NAME consumer.components_agree COMMAND ${consumer}/components/components)
set_tests_properties(consumer.components_agree PROPERTIES FIXTURES_REQUIRED consumer_components
                                                          PASS_REGULAR_EXPRESSION "path-pair -4\ncbc -4\nlp-rounding -4")

# The package names no path of the machine that built it, and at most 25 headers are public.
add_test(NAME consumer.package_is_relocatable
         COMMAND ${CMAKE_COMMAND} -D PREFIX=${consumer}/prefix -D SOURCES=${PROJECT_SOURCE_DIR}
                                  -P ${CMAKE_CURRENT_LIST_DIR}/relocatable.cmake)
set_tests_properties(consumer.package_is_relocatable PROPERTIES FIXTURES_REQUIRED consumer_prefix)

# Most build the core again, which takes minutes. Tests that only configure or install run every day.
get_property(all_tests DIRECTORY PROPERTY TESTS)
foreach(test IN LISTS all_tests)
    if(test MATCHES "^consumer[.]" AND NOT test MATCHES "needs_eigen_alone|names_what_it_needs|relocatable")
        set_tests_properties(${test} PROPERTIES LABELS consumer.long)
    endif()
endforeach()
