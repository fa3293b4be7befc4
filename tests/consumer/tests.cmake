# Installs the build into a prefix of its own, then configures, builds and runs this folder's project against it.
set(prefix ${CMAKE_CURRENT_BINARY_DIR}/consumer/prefix)
add_test(NAME consumer.clean COMMAND ${CMAKE_COMMAND} -E rm -rf ${CMAKE_CURRENT_BINARY_DIR}/consumer)
add_test(NAME consumer.install COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR} --prefix ${prefix})
add_test(NAME consumer.build_and_run
         COMMAND ${CMAKE_CTEST_COMMAND} --build-and-test ${CMAKE_CURRENT_LIST_DIR}
                 ${CMAKE_CURRENT_BINARY_DIR}/consumer/build --build-generator ${CMAKE_GENERATOR} --build-options
                 -D conelane_ROOT=${prefix} -D CMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
                 -D CMAKE_CXX_FLAGS=${CMAKE_CXX_FLAGS} --test-command consumer)
set_tests_properties(consumer.clean PROPERTIES FIXTURES_SETUP consumer_clean)
set_tests_properties(consumer.install PROPERTIES FIXTURES_REQUIRED consumer_clean FIXTURES_SETUP consumer_prefix)
set_tests_properties(consumer.build_and_run PROPERTIES FIXTURES_REQUIRED consumer_prefix
                                                       PASS_REGULAR_EXPRESSION "1 3 5 [|] 2 4 6\n1 3 5 [|] 2 4 6")
