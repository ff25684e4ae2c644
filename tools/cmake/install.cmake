# `cmake --install build --prefix P`: libraries, public headers, the program, the scenes, and a package for find_package(lodestone).
include(CMakePackageConfigHelpers)
set(LODESTONE_PACKAGE ${CMAKE_INSTALL_LIBDIR}/cmake/lodestone)

set_target_properties(lodestone_scenes PROPERTIES EXPORT_NAME scenes)
install(TARGETS lodestone lodestone_scenes EXPORT lodestone ARCHIVE)
install(TARGETS lodestone_cli RUNTIME)
# An internal header says so in its name.
install(DIRECTORY reference signature lod scenes DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lodestone
  FILES_MATCHING PATTERN "*.h" PATTERN "*_ode.h" EXCLUDE PATTERN "*_internal.h" EXCLUDE)
install(DIRECTORY scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/lodestone/scenes
  PATTERN "*.h" EXCLUDE PATTERN "*.cpp" EXCLUDE PATTERN "*.png" EXCLUDE)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/lodestone)

install(EXPORT lodestone NAMESPACE lodestone:: FILE lodestoneTargets.cmake DESTINATION ${LODESTONE_PACKAGE})
configure_package_config_file(tools/cmake/lodestoneConfig.cmake.in lodestoneConfig.cmake INSTALL_DESTINATION ${LODESTONE_PACKAGE})
write_basic_package_version_file(lodestoneConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/lodestoneConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/lodestoneConfigVersion.cmake
  DESTINATION ${LODESTONE_PACKAGE})
