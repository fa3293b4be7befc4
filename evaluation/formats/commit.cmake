# Writes OUTPUT, a source file that says which commit of SOURCE_DIR is built; touched only where that has changed.
execute_process(
    COMMAND git -c safe.directory=${SOURCE_DIR} describe --always --dirty --abbrev=12 --exclude=*
    WORKING_DIRECTORY ${SOURCE_DIR}
    OUTPUT_VARIABLE commit
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT commit)
    set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
namespace conelane {
extern const char* const kBuiltCommit;
const char* const kBuiltCommit = "@commit@";
}  // namespace conelane
]])
