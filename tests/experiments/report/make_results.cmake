# cmake -D PROGRAM=conelane -D BENCHMARKS=conelane_benchmarks -D RESULTS=DIR -P make_results.cmake: a small comparison,
# a sweep, what is measured of exactness, and their page. BENCHMARKS may be empty.
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
conelane(study anytime --scenes ${scenes} --limit 6 --limits 0.1,400 --out ${RESULTS}/anytime.jsonl)
conelane(study growth --scenes ${scenes} --sizes 6,12 --limit 6 --out ${RESULTS}/growth.jsonl)
conelane(study formulations --scenes ${scenes} --sizes 6 --limit 10 --out ${RESULTS}/formulations.jsonl)
conelane(study relaxations --scenes ${scenes} --sizes 8 --limit 4 --out ${RESULTS}/relaxations.jsonl)
conelane(tune --tracks generated:straight generated:circle --nearest 8 --fp 0.3 --every 40 --folds 2 --evaluations 1
         --out ${RESULTS}/tuned.json)
conelane(study confidence-and-colour --record ${RESULTS}/tuned.record.json
         --out ${RESULTS}/confidence-and-colour.jsonl)
conelane(race --tracks generated:kidney --methods front,none --fp 0,0.3 --out ${RESULTS}/race)
if(BENCHMARKS)
    execute_process(COMMAND ${BENCHMARKS} "--benchmark_filter=^(problem|build|update)/(tight|paper)/6$"
                            --benchmark_min_time=0.01 --benchmark_out_format=json
                            --benchmark_out=${RESULTS}/benchmarks.json
                    OUTPUT_QUIET ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
endif()
conelane(report --results ${RESULTS} --out ${RESULTS}/page.html)
