# What is installed: libraries, the headers that hosts include, and how CMake and pkg-config find them.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/motley)
install(TARGETS motley EXPORT motleyTargets LIBRARY COMPONENT runtime NAMELINK_COMPONENT development)
# A package of the shared library has the static one too.
if(BUILD_SHARED_LIBS AND TARGET motley_program)
    install(FILES $<TARGET_FILE:motley_inside> DESTINATION ${CMAKE_INSTALL_LIBDIR} RENAME libmotley.a)
endif()
if(TARGET motley_program)
    install(TARGETS motley_program RUNTIME COMPONENT program)
endif()
if(TARGET motley_python)
    install(DIRECTORY ${PROJECT_BINARY_DIR}/parallel/python/motley DESTINATION lib/python3/dist-packages COMPONENT python
        PATTERN __pycache__ EXCLUDE)
endif()
motley_install_amalgamated(motley/motley.h)
motley_install_amalgamated(motley/c/motley.h)
install(EXPORT motleyTargets NAMESPACE motley:: DESTINATION ${package_dir})
# Who links the static library links oneTBB too.
set(MOTLEY_NEEDS_TBB OFF)
if(MOTLEY_TBB AND NOT BUILD_SHARED_LIBS)
    set(MOTLEY_NEEDS_TBB ON)
endif()
configure_package_config_file(${PROJECT_SOURCE_DIR}/.cmake/motleyConfig.cmake.in motleyConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(motleyConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/motleyConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/motleyConfigVersion.cmake
    DESTINATION ${package_dir})

# For those who build without CMake.
set(MOTLEY_PC_LIBS "")
if(MOTLEY_NEEDS_TBB)
    set(MOTLEY_PC_LIBS " -ltbb -lpthread")
endif()
set(MOTLEY_PC_CFLAGS "")
if(MOTLEY_FLOAT_POSITIONS)
    set(MOTLEY_PC_CFLAGS " -DMOTLEY_FLOAT_POSITIONS")
endif()
configure_file(${PROJECT_SOURCE_DIR}/.cmake/motley.pc.in motley.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/motley.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
