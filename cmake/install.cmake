# `cmake --install` puts the header-only core where find_package(furcula) finds it.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
install(TARGETS furcula EXPORT furculaTargets)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/common/include/furcula DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT furculaTargets NAMESPACE furcula:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/furcula)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/furculaConfig.cmake.in
  ${PROJECT_BINARY_DIR}/furculaConfig.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/furcula)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/furculaConfigVersion.cmake
  COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${PROJECT_BINARY_DIR}/furculaConfig.cmake ${PROJECT_BINARY_DIR}/furculaConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/furcula)
