# WebAssembly from Linux, by Emscripten: .ci/test-wasm copies what it needs and runs the tests by node.
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
list(APPEND CMAKE_FIND_ROOT_PATH ${CMAKE_CURRENT_LIST_DIR}/../build/wasm-root)
# Refusals are exceptions.
set(CMAKE_CXX_FLAGS_INIT -fexceptions)
# This version of Emscripten takes node for a browser where node is able to fetch.
set(CMAKE_CROSSCOMPILING_EMULATOR /usr/bin/node --no-experimental-fetch)
# A page takes memory as it needs it, and tests read and write the files of the machine.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-fexceptions -sALLOW_MEMORY_GROWTH -sEXIT_RUNTIME -sNODERAWFS -sTOTAL_STACK=4MB")
