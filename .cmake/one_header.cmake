# Installed headers: one for each library that a host may link. Each has in itself what it includes of motley, so that a host sees
# one page, and finds nothing else to include.

# Puts into the variable `result` the text of a header, in which each line that includes a header of motley is replaced by the text of
# that header, the first time that it is included, or by nothing. `name` is as in the line: motley/motley.h. The global property
# motley_amalgamated lists the headers that have been put in.
function(motley_amalgamate name result)
    get_property(amalgamated GLOBAL PROPERTY motley_amalgamated)
    set(text "")
    if(NOT name IN_LIST amalgamated)
        set_property(GLOBAL APPEND PROPERTY motley_amalgamated ${name})
        foreach(room core soa parallel)
            set(file ${PROJECT_SOURCE_DIR}/${room}/include/${name})
            if(EXISTS ${file})
                break()
            endif()
        endforeach()
        set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
        file(READ ${file} rest)
        while(rest MATCHES "#include \"(motley/[a-z0-9_/]+\\.h)\"\n")
            set(line "${CMAKE_MATCH_0}")
            set(included ${CMAKE_MATCH_1})
            string(FIND "${rest}" "${line}" place)
            string(SUBSTRING "${rest}" 0 ${place} before)
            string(LENGTH "${line}" length)
            math(EXPR place "${place} + ${length}")
            string(SUBSTRING "${rest}" ${place} -1 rest)
            motley_amalgamate(${included} inside)
            string(REPLACE "#pragma once\n" "" inside "${inside}")
            string(APPEND text "${before}${inside}")
        endwhile()
        string(APPEND text "${rest}")
    endif()
    set(${result} "${text}" PARENT_SCOPE)
endfunction()

# Installs a header with this text.
function(motley_install_header_text name text)
    file(WRITE ${PROJECT_BINARY_DIR}/include/${name} "${text}")
    get_filename_component(folder ${name} DIRECTORY)
    install(FILES ${PROJECT_BINARY_DIR}/include/${name} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder})
endfunction()

# Installs a header of the library with all that it includes of motley.
function(motley_install_amalgamated name)
    set_property(GLOBAL PROPERTY motley_amalgamated "")
    motley_amalgamate(${name} text)
    motley_install_header_text(${name} "${text}")
endfunction()

# Installs the header `name` of a library beside motley, which lies in include/ here. What it includes of motley is
# <motley/motley.h> once it is installed.
function(motley_install_beside name)
    set(file ${CMAKE_CURRENT_SOURCE_DIR}/include/${name})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(READ ${file} text)
    string(REGEX REPLACE "(#include \"motley/[a-z0-9_/]+\\.h\"\n)+" "#include \"motley/motley.h\"\n" text "${text}")
    motley_install_header_text(${name} "${text}")
endfunction()
