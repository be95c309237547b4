# Machines that motley is right on: 64 bits, little-endian, or WebAssembly. On 32-bit x86 the compiler keeps numbers in more
# digits than they have, and scenes are saved in the byte order of the machine.
if(NOT CMAKE_SIZEOF_VOID_P EQUAL 8 AND NOT EMSCRIPTEN)
    math(EXPR bits "8 * ${CMAKE_SIZEOF_VOID_P}")
    message(FATAL_ERROR "motley: this compiler builds for ${bits} bits; expected 64, or WebAssembly by Emscripten")
endif()
if(CMAKE_CXX_BYTE_ORDER AND NOT CMAKE_CXX_BYTE_ORDER STREQUAL LITTLE_ENDIAN)
    message(FATAL_ERROR "motley: this compiler builds for a big-endian machine; expected little-endian")
endif()
