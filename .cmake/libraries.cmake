# motley as a shared and as a static library, of the same objects.

# Hides the functions of std and of other libraries that the compiler made for this one: they are weak and visible,
# whatever the visibility of everything else.
function(motley_show_only_what_is_public library)
    if(CMAKE_EXECUTABLE_FORMAT STREQUAL ELF)
        set(map ${PROJECT_SOURCE_DIR}/.cmake/exports.map)
        target_link_options(${library} PRIVATE LINKER:--version-script=${map})
        set_property(TARGET ${library} APPEND PROPERTY LINK_DEPENDS ${map})
    endif()
endfunction()

# Adds a library of the objects that motley is made of, which is built only for those who link it.
function(motley_same_library library kind)
    get_target_property(objects motley SOURCES)
    add_library(${library} ${kind} EXCLUDE_FROM_ALL ${objects})
    target_compile_features(${library} PUBLIC cxx_std_20)
    target_include_directories(${library} PUBLIC $<TARGET_PROPERTY:motley,INTERFACE_INCLUDE_DIRECTORIES>)
    target_compile_definitions(${library} PUBLIC $<TARGET_PROPERTY:motley,INTERFACE_COMPILE_DEFINITIONS>)
    if(MOTLEY_TBB)
        target_link_libraries(${library} PRIVATE TBB::tbb)
    endif()
    if(kind STREQUAL SHARED)
        motley_show_only_what_is_public(${library})
    endif()
endfunction()
