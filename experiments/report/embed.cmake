# cmake -D FOLDER=DIR -D ARCHIVE=FILE -D OUTPUT=FILE -P embed.cmake: the report's Python package as a zip archive, and
# that as bytes in a C++ source. The same sources give the same bytes.
cmake_minimum_required(VERSION 3.22...3.25)

get_filename_component(package ${FOLDER} NAME)
get_filename_component(parent ${FOLDER} DIRECTORY)
file(GLOB_RECURSE sources RELATIVE ${parent} ${FOLDER}/*.py ${FOLDER}/*.js ${FOLDER}/*.mjs ${FOLDER}/*.css ${FOLDER}/*.json)
list(SORT sources)
execute_process(COMMAND ${CMAKE_COMMAND} -E env TZ=UTC ${CMAKE_COMMAND} -E tar cf ${ARCHIVE} --format=zip
                        "--mtime=2000-01-01 00:00:00" -- ${sources}
                WORKING_DIRECTORY ${parent} COMMAND_ERROR_IS_FATAL ANY)
file(READ ${ARCHIVE} bytes HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
string(REGEX REPLACE "(................................................................................)" "\\1\n"
                     bytes "${bytes}")
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "experiments/report/report.hpp"

namespace conelane::experiments {
namespace {

constexpr unsigned char kBytes[] = {
@bytes@
};

}  // namespace

std::span<const unsigned char> report_archive() {
    return kBytes;
}

}  // namespace conelane::experiments
]])
