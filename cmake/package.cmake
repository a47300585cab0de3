# `cpack -G DEB` (scripts/package): one Debian package with the program, furculad and its service, the header-only core and the pages.
# What is not the core is installed for the package only: `cmake --install` alone still needs neither program.
include(GNUInstallDirs)
install(TARGETS furcula_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program EXCLUDE_FROM_ALL)
if(TARGET furculad)
  install(TARGETS furculad RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program EXCLUDE_FROM_ALL)
  # The service starts the package's program.
  file(READ ${PROJECT_SOURCE_DIR}/boards/linux_sbc/furculad.service service)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/boards/linux_sbc/furculad.service)
  string(REPLACE /usr/local/bin/ /usr/bin/ service "${service}")
  file(WRITE ${PROJECT_BINARY_DIR}/package/furculad.service "${service}")
  install(FILES ${PROJECT_BINARY_DIR}/package/furculad.service DESTINATION lib/systemd/system COMPONENT program EXCLUDE_FROM_ALL)
  install(FILES ${PROJECT_SOURCE_DIR}/boards/linux_sbc/furculad.toml DESTINATION /etc/furcula COMPONENT program EXCLUDE_FROM_ALL)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/furcula
  COMPONENT program EXCLUDE_FROM_ALL)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/furcula
  COMPONENT program EXCLUDE_FROM_ALL)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/furcula COMPONENT program EXCLUDE_FROM_ALL)

set(CPACK_PACKAGE_NAME furcula)
set(CPACK_PACKAGE_VENDOR "the Furcula project")
set(CPACK_PACKAGE_CONTACT "the Furcula project <furcula@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "finds out why a simulated legged robot does not hop like the real one")
set(CPACK_PACKAGE_DESCRIPTION "From measured logs and a model file it names the physical cause and how much the model gains by it.
 With furculad, the controller of a hopping robot on a Linux computer, and the header-only core.")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL Unspecified program)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
if(TARGET furculad)
  file(WRITE ${PROJECT_BINARY_DIR}/package/conffiles "/etc/furcula/furculad.toml\n")
  set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/package/conffiles ${PROJECT_SOURCE_DIR}/cmake/debian/postinst
    ${PROJECT_SOURCE_DIR}/cmake/debian/prerm)
endif()
include(CPack)
