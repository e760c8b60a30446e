# Installs the C library for other programs: headers, static and shared library, and what
# pkg-config and CMake's find_package need to link them.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(shared_name "libanalytic_media.so.${AM_SOVERSION}")

install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES "${AM_STATIC_LIBRARY}" DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(FILES "${AM_SHARED_LIBRARY}" DESTINATION ${CMAKE_INSTALL_LIBDIR} RENAME ${shared_name})
file(CREATE_LINK ${shared_name} "${PROJECT_BINARY_DIR}/libanalytic_media.so" SYMBOLIC)
install(FILES "${PROJECT_BINARY_DIR}/libanalytic_media.so" DESTINATION ${CMAKE_INSTALL_LIBDIR})

# What a Rust static library needs from the system (rustc --print native-static-libs).
set(AM_SYSTEM_LIBRARIES "-lgcc_s -lutil -lrt -lpthread -lm -ldl -lc")
file(RELATIVE_PATH AM_PREFIX_FROM_PC "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
configure_file(cmake/analytic_media.pc.in "${PROJECT_BINARY_DIR}/analytic_media.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/analytic_media.pc"
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/analytic_media)
configure_package_config_file(cmake/analytic_mediaConfig.cmake.in
  "${PROJECT_BINARY_DIR}/analytic_mediaConfig.cmake"
  INSTALL_DESTINATION ${package_dir}
  PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/analytic_mediaConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/analytic_mediaConfig.cmake"
              "${PROJECT_BINARY_DIR}/analytic_mediaConfigVersion.cmake"
        DESTINATION ${package_dir})
