# The lines of the README that embed motley are the consumer's, letter for letter, and that is built and run.
file(READ ${README} readme)
file(READ ${MAIN} main)
string(FIND "${readme}" "${main}" found)
if(found EQUAL -1)
    message(FATAL_ERROR "README.md does not hold tests/consumer/main.cpp as it is")
endif()
