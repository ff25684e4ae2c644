# `cmake --install build --prefix P`: libraries, public headers, the program, the scenes, and packages for find_package(lodestone) and pkg-config.
include(CMakePackageConfigHelpers)
set(LODESTONE_PACKAGE ${CMAKE_INSTALL_LIBDIR}/cmake/lodestone)

set(LODESTONE_INSTALLED lodestone)
set(LODESTONE_PUBLIC ${LODESTONE_PUBLIC_ENGINE})
if(LODESTONE_BUILD_SCENES)
  set_target_properties(lodestone_scenes PROPERTIES EXPORT_NAME scenes)
  list(APPEND LODESTONE_INSTALLED lodestone_scenes)
  list(APPEND LODESTONE_PUBLIC ${LODESTONE_PUBLIC_SCENES})
  install(DIRECTORY scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/lodestone/scenes
    PATTERN "*.h" EXCLUDE PATTERN "*.cpp" EXCLUDE PATTERN "*.png" EXCLUDE)
endif()
install(TARGETS ${LODESTONE_INSTALLED} EXPORT lodestone ARCHIVE LIBRARY)
if(LODESTONE_BUILD_TOOLS)
  install(TARGETS lodestone_cli RUNTIME)
endif()
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/lodestone)

# Which headers are public is found when they are installed: an include that is added since the build was configured counts.
install(CODE "
  include(\"${PROJECT_SOURCE_DIR}/tools/cmake/public_headers.cmake\")
  lodestone_public_headers(HEADERS \"${PROJECT_SOURCE_DIR}\" ${LODESTONE_PUBLIC})
  foreach(HEADER \${HEADERS})
    cmake_path(GET HEADER PARENT_PATH FOLDER)
    file(INSTALL \"${PROJECT_SOURCE_DIR}/\${HEADER}\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/lodestone/\${FOLDER}\")
  endforeach()")
install(FILES lod/lodestone.h lod/lodestone_c.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lodestone)

install(EXPORT lodestone NAMESPACE lodestone:: FILE lodestoneTargets.cmake DESTINATION ${LODESTONE_PACKAGE})
configure_package_config_file(tools/cmake/lodestoneConfig.cmake.in lodestoneConfig.cmake INSTALL_DESTINATION ${LODESTONE_PACKAGE})
write_basic_package_version_file(lodestoneConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/lodestoneConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/lodestoneConfigVersion.cmake
  DESTINATION ${LODESTONE_PACKAGE})

# A static library is linked together with what it uses, with or without --static.
if(NOT BUILD_SHARED_LIBS)
  set(LODESTONE_PC_REQUIRES ", ode, ccd, libxxhash, qhull_r, assimp, tbb, fmt")
  set(LODESTONE_PC_LIBS " -lmeshoptimizer -lstdc++ -lm -pthread")
endif()
file(RELATIVE_PATH LODESTONE_PREFIX_FROM_PC "/p/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/p")
configure_file(tools/cmake/lodestone.pc.in lodestone.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/lodestone.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
