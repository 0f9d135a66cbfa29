# What `cmake --install` does beside the libraries (silpose_module) and the command: the umbrella header, the data, and
# the CMake package. Data that was not fetched is left out.
set(SILPOSE_SHARE_DIR ${CMAKE_INSTALL_DATADIR}/silpose)
install(FILES ${PROJECT_SOURCE_DIR}/src/silpose/silpose.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/silpose)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/experiments DESTINATION ${SILPOSE_SHARE_DIR})
foreach(folder makehuman networks)
  install(DIRECTORY ${SILPOSE_DATA_DIR}/${folder}/ DESTINATION ${SILPOSE_SHARE_DIR}/${folder} OPTIONAL)
endforeach()
install(FILES ${SILPOSE_DATA_DIR}/human.body DESTINATION ${SILPOSE_SHARE_DIR} OPTIONAL)

include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/silpose)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/silposeConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/silposeConfig.cmake
                              INSTALL_DESTINATION ${package_dir} PATH_VARS SILPOSE_SHARE_DIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/silposeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/silposeConfig.cmake ${PROJECT_BINARY_DIR}/silposeConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/libraries.cmake DESTINATION ${package_dir})
install(EXPORT silposeTargets NAMESPACE silpose:: DESTINATION ${package_dir})
