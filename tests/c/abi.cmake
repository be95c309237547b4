# The binary interface of C, as a host that is built already knows it (calls, their parameters, the layout of what they take
# and the values of enumerations) is still that of abi-1.xml, which was written when the interface was released; additions
# are allowed. abidw describes compiled calls: each call of the headers gets a body that does nothing.
#   cmake -DCOMPILER=cc -DSOURCE=. -DDIRECTORY=build [-DRELEASE=ON] -P tests/c/abi.cmake
# RELEASE writes abi-1.xml instead: only when MOTLEY_C_VERSION has become another one.
cmake_minimum_required(VERSION 3.22)
set(abi ${SOURCE}/tests/c/abi-1.xml)
set(include ${SOURCE}/parallel/include)
execute_process(COMMAND ${COMPILER} -std=c99 -E -P -I${include} ${include}/motley/c/motley.h OUTPUT_VARIABLE text
    COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE "#pragma[^\n]*" "" text "${text}")
# A semicolon would separate elements of a list.
string(REPLACE ";" "@" text "${text}")
string(REGEX REPLACE "[ \n]+" " " text "${text}")
string(REGEX MATCHALL "[a-z][a-z0-9_ *]*[ *]motley_[a-z0-9_]+\\([^@{}]*\\)@" calls "${text}")
file(STRINGS ${SOURCE}/tests/c/symbols.txt listed)
list(LENGTH listed expected)
list(LENGTH calls count)
if(NOT count EQUAL expected)
    message(FATAL_ERROR "finds ${count} calls in the headers; tests/c/symbols.txt lists ${expected}")
endif()
list(TRANSFORM calls REPLACE "@$" " { while (1) {} }")
list(JOIN calls "\n" calls)
file(WRITE ${DIRECTORY}/abi.c "#include <motley/c/motley.h>\n${calls}\n")
execute_process(COMMAND ${COMPILER} -std=c99 -g -gdwarf-4 -fPIC -shared -nostdlib -I${include} -o ${DIRECTORY}/abi.so ${DIRECTORY}/abi.c
    COMMAND_ERROR_IS_FATAL ANY)
if(RELEASE)
    execute_process(COMMAND abidw --no-show-locs --no-comp-dir-path --no-corpus-path --out-file ${abi} ${DIRECTORY}/abi.so
        COMMAND_ERROR_IS_FATAL ANY)
    return()
endif()
execute_process(COMMAND abidiff --no-added-syms --suppressions ${SOURCE}/tests/c/abi-growth.abignore ${abi} ${DIRECTORY}/abi.so RESULT_VARIABLE result OUTPUT_VARIABLE changes
    ERROR_VARIABLE changes)
if(NOT result EQUAL 0)
    message(FATAL_ERROR "hosts that are built already expect another interface than the headers have:\n${changes}")
endif()
