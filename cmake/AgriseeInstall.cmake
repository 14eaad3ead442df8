# SPDX-License-Identifier: BSD-3-Clause
# Install rules and the exported package.
include(CMakePackageConfigHelpers)
set(AGRISEE_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/agrisee)
set(AGRISEE_TARGETS agrisee)
if(AGRISEE_BUILD_IO)
  list(APPEND AGRISEE_TARGETS agrisee_io)
endif()
install(TARGETS ${AGRISEE_TARGETS} EXPORT agrisee-targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
if(AGRISEE_BUILD_CLI)
  install(TARGETS agrisee_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(DIRECTORY include/agrisee DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT agrisee-targets NAMESPACE agrisee:: DESTINATION ${AGRISEE_CMAKE_DIR})
configure_package_config_file(cmake/agrisee-config.cmake.in ${PROJECT_BINARY_DIR}/agrisee-config.cmake
  INSTALL_DESTINATION ${AGRISEE_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/agrisee-config-version.cmake
  VERSION ${PROJECT_VERSION} COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/agrisee-config.cmake ${PROJECT_BINARY_DIR}/agrisee-config-version.cmake
  DESTINATION ${AGRISEE_CMAKE_DIR})
