# What `cmake --install` puts where: the components are `runtime`, `development` and `tools`.

include(CMakePackageConfigHelpers)

install(FILES include/ofc.h include/ofc.hpp DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT development)
install(FILES "${ofc_archive}" DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development)
if(ofc_shared)
  install(FILES "${ofc_shared}" "${ofc_lib}/libofc.so.${ofc_abi}"
    DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT runtime)
  if(OFC_HWCAPS)
    install(FILES "${ofc_lib}/${ofc_wide}/libofc.so.${PROJECT_VERSION}" "${ofc_lib}/${ofc_wide}/libofc.so.${ofc_abi}"
      DESTINATION "${CMAKE_INSTALL_LIBDIR}/${ofc_wide}" COMPONENT runtime)
  endif()
  install(FILES "${ofc_lib}/libofc.so" DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development)
endif()

# Both find the installation from where they lie, so that it may be moved.
set(ofc_pkgconfig "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
file(RELATIVE_PATH ofc_prefix "/prefix/${ofc_pkgconfig}" "/prefix")
string(REGEX REPLACE "/$" "" ofc_prefix "${ofc_prefix}")
configure_file(ofc-ffi/package/ofc.pc.in "${PROJECT_BINARY_DIR}/ofc.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/ofc.pc" DESTINATION "${ofc_pkgconfig}" COMPONENT development)

set(ofc_config "${CMAKE_INSTALL_LIBDIR}/cmake/ofc")
configure_package_config_file(ofc-ffi/package/ofcConfig.cmake.in "${PROJECT_BINARY_DIR}/ofcConfig.cmake"
  INSTALL_DESTINATION "${ofc_config}"
  PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/ofcConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/ofcConfig.cmake" "${PROJECT_BINARY_DIR}/ofcConfigVersion.cmake"
  DESTINATION "${ofc_config}" COMPONENT development)
