# cmake -D PROGRAM=conelane -D RESULTS=DIR -P make_results.cmake: a small comparison, a sweep and their page.
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${RESULTS})
function(conelane)
    execute_process(COMMAND ${PROGRAM} ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
conelane(compare --tracks generated:straight generated:circle --methods rld-cbc,rld-pair,clc --fp 0,0.3 --every 15
         --candidates --out ${RESULTS})
conelane(sweep --tracks generated:straight generated:circle --methods rld-pair,clc --sizes 6,12 --every 40
         --out ${RESULTS}/sweep)
conelane(report --results ${RESULTS} --out ${RESULTS}/page.html)
