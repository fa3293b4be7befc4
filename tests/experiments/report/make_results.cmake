# cmake -D PROGRAM=conelane -D RESULTS=DIR -P make_results.cmake: a small comparison, a sweep, what is measured of exactness,
# and their page.
cmake_minimum_required(VERSION 3.22...3.25)

file(REMOVE_RECURSE ${RESULTS})
function(conelane)
    execute_process(COMMAND ${PROGRAM} ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
conelane(compare --tracks generated:straight generated:circle --methods rld-cbc,rld-pair,clc --fp 0,0.3 --every 15
         --condition paper,car --candidates --out ${RESULTS})
conelane(sweep --tracks generated:straight generated:circle --methods rld-cbc,rld-pair,clc --sizes 6,12 --every 40
         --out ${RESULTS}/sweep)
set(scenes ${RESULTS}/scenes.scenes.jsonl)
conelane(study optimality --params default,shape --scenes ${scenes} --out ${RESULTS}/optimality.jsonl)
conelane(study backends --warm-start --permutations 1 --gap-limits 0.1,1 --scenes ${scenes} --sizes 6 --out ${RESULTS}/backends.jsonl)
conelane(study relaxations --scenes ${scenes} --sizes 8 --limit 4 --out ${RESULTS}/relaxations.jsonl)
conelane(study growth --scenes ${scenes} --sizes 6,12 --limit 6 --out ${RESULTS}/growth.jsonl)
conelane(study formulations --scenes ${scenes} --sizes 6 --limit 10 --out ${RESULTS}/formulations.jsonl)
conelane(race --tracks generated:kidney --methods front,none --fp 0,0.3 --out ${RESULTS}/race)
conelane(report --results ${RESULTS} --out ${RESULTS}/page.html)
