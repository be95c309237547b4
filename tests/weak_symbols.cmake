# Code compiled for a wide instruction set must not be offered to the rest of the program: the linker keeps one
# copy of a weak function, and a processor without that instruction set would run into it. A name that holds the
# instruction set's own type cannot be asked for elsewhere.
string(REPLACE "," ";" objects "${OBJECTS}")
foreach(object ${objects})
    execute_process(COMMAND nm -C --defined-only ${object} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
    string(REPLACE "\n" ";" symbols "${symbols}")
    foreach(symbol ${symbols})
        if(symbol MATCHES "^[0-9a-f]* [WVu] " AND NOT symbol MATCHES "xsimd::(avx|fma3)|__m256|__m512|DW.ref|GCC_except_table")
            message(SEND_ERROR "${object}: weak ${symbol}")
        endif()
    endforeach()
endforeach()
