# The stored scenes of the playground are what the program makes and answers today.
execute_process(COMMAND ${PYTHON} ${SCRIPT} ${PROGRAM} ${OUT} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${OUT} ${STORED} RESULT_VARIABLE differs)
if(differs)
    message(FATAL_ERROR "${STORED} is not what the program answers now. To store it again: python3 ${SCRIPT} ${PROGRAM} ${STORED}")
endif()
