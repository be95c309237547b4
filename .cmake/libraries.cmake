# motley as a shared and as a static library, of the same objects, and the libraries beside it.

# Hides the functions of std and of other libraries that the compiler made for this one: they are weak and visible,
# whatever the visibility of everything else.
function(motley_show_only_what_is_public library)
    if(CMAKE_EXECUTABLE_FORMAT STREQUAL ELF)
        set(map ${PROJECT_SOURCE_DIR}/.cmake/exports.map)
        target_link_options(${library} PRIVATE LINKER:--version-script=${map})
        set_property(TARGET ${library} APPEND PROPERTY LINK_DEPENDS ${map})
    endif()
endfunction()

# Adds a library beside motley that reads files by another library, so that motley itself need not link that one:
# motley_add_reader(wkt Wkt GEOS::geos_c SOURCES...) makes motley::wkt, and exports it as motleyWktTargets.
function(motley_add_reader name export reads_by)
    set(library motley_${name})
    add_library(${library} ${ARGN})
    add_library(motley::${name} ALIAS ${library})
    set_target_properties(${library} PROPERTIES POSITION_INDEPENDENT_CODE ON EXPORT_NAME ${name} VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
    target_include_directories(${library} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    target_include_directories(${library} PRIVATE ${PROJECT_SOURCE_DIR}/core/src)
    target_link_libraries(${library} PUBLIC motley PRIVATE ${reads_by} $<BUILD_INTERFACE:motley_flags>)
    install(TARGETS ${library} EXPORT motley${export}Targets LIBRARY COMPONENT readers NAMELINK_COMPONENT development)
    motley_install_beside(motley/${name}/${name}.h)
    install(EXPORT motley${export}Targets NAMESPACE motley:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/motley)
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
