# <motley/motley.h> in INCLUDE gives a host's file at most 4,000 lines more to compile than headers of the standard library do that
# nearly every file includes. COMPILER preprocesses both; lines without code are not counted.
cmake_minimum_required(VERSION 3.22)
function(count_lines headers result)
    string(REGEX REPLACE "([^ ]+) ?" "#include <\\1>\n" text "${headers}")
    file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/preprocessed_lines.cpp "${text}")
    execute_process(COMMAND ${COMPILER} -std=c++20 -I${INCLUDE} -E -P ${CMAKE_CURRENT_BINARY_DIR}/preprocessed_lines.cpp
        COMMAND grep -c "[^ ]" OUTPUT_VARIABLE lines OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
    set(${result} ${lines} PARENT_SCOPE)
endfunction()
count_lines("vector string span memory optional" usual)
count_lines("vector string span memory optional motley/motley.h" all)
math(EXPR more "${all} - ${usual}")
message(STATUS "${all} lines, ${more} more than without motley")
if(more LESS 500 OR more GREATER 4000)
    message(FATAL_ERROR "<motley/motley.h> adds ${more} lines; expected 500 to 4000")
endif()
