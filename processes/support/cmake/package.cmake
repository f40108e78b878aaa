# What `cmake --install` puts down beside the programs, and the Debian package
# (`cpack -G DEB` in the build folder).
include(CMakePackageConfigHelpers)
set(_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Waymark)
set(WAYMARK_CONFIG_DIR ${CMAKE_INSTALL_DATADIR}/waymark/config)
configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/WaymarkConfig.cmake.in
  ${CMAKE_BINARY_DIR}/WaymarkConfig.cmake
  INSTALL_DESTINATION ${_cmake_dir} PATH_VARS WAYMARK_CONFIG_DIR)
# Before 1.0 each minor version may change the interfaces.
write_basic_package_version_file(${CMAKE_BINARY_DIR}/WaymarkConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/WaymarkConfig.cmake
  ${CMAKE_BINARY_DIR}/WaymarkConfigVersion.cmake DESTINATION ${_cmake_dir})
install(EXPORT WaymarkTargets NAMESPACE Waymark:: DESTINATION ${_cmake_dir})
set(_doc_dir ${CMAKE_INSTALL_DATAROOTDIR}/doc/waymark)
install(FILES README.md CHANGELOG.md LICENSE NOTICE DESTINATION ${_doc_dir})
install(FILES NOTICE DESTINATION ${_doc_dir} RENAME copyright)
install(DIRECTORY DESTINATION ${WAYMARK_CONFIG_DIR})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME waymark)
set(CPACK_PACKAGE_VENDOR "Waymark")
set(CPACK_PACKAGE_CONTACT "The Waymark authors <waymark@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION
"Processes that fuse wheel ticks with whatever else says where an indoor robot
is, learn its wheel parameters, and talk over LCM; tools that import, check,
replay and evaluate recordings; headers and a CMake package for own processes.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# Libraries are found from the programs; the rest serves what not all need:
# recording and playing, lcm-spy, own processes.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "liblcm-bin, iproute2")
string(CONCAT CPACK_DEBIAN_PACKAGE_SUGGESTS
  "liblcm-java, libjchart2d-java, openjdk-17-jre, python3, g++, cmake, "
  "liblcm-dev, libeigen3-dev, libyaml-cpp-dev, libspdlog-dev")
include(CPack)
