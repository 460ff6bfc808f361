# Debian packages by CPack: the library, what programs that link it need, and the programs. Configured with the prefix /usr.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_CONTACT "The ofc authors <ofc@users.noreply.github.com>" CACHE STRING "The maintainer of the packages")
set(CPACK_COMPONENTS_ALL runtime development)
if(OFC_TOOLS)
  list(APPEND CPACK_COMPONENTS_ALL tools)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "surface normals from one color picture")
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

# Policy 8.1: the package is named after the SONAME, which is libofc.so.0.2 for any 0.2.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME "libofc${ofc_abi}")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "Gives the surface normals of a matte object of one color from one RGB picture
under lights of unknown colors and directions, how sure each normal is, and
depth. It allocates nothing and needs no other library.")
# CPack would write these itself, together with scripts that call ldconfig, which policy has given up.
file(WRITE "${PROJECT_BINARY_DIR}/shlibs" "libofc ${ofc_abi} libofc${ofc_abi} (>= ${PROJECT_VERSION})\n")
file(WRITE "${PROJECT_BINARY_DIR}/triggers" "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA "${PROJECT_BINARY_DIR}/shlibs;${PROJECT_BINARY_DIR}/triggers")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libofc-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "The headers for C and C++, the static library, and what pkg-config and CMake
want to know, for programs that link ofc.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libofc${ofc_abi} (= ${PROJECT_VERSION})")

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME ofc-tools)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "ofc-photo writes the normals, their uncertainty, depth and a mesh of a
photograph, ofc-integrate makes depth of any normal map, and ofc-table1 does
the experiment of the method's paper on any range map.")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS gnuplot-nox)

# The documents that policy wants in every package, and that are not part of an installation elsewhere.
string(TIMESTAMP ofc_date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE "${PROJECT_BINARY_DIR}/changelog" "ofc (${PROJECT_VERSION}) unstable; urgency=medium\n\n"
  "  * Version ${PROJECT_VERSION}; CHANGELOG.md of its sources says what is new.\n\n"
  " -- ${CPACK_PACKAGE_CONTACT}  ${ofc_date}\n")
execute_process(COMMAND gzip -9nf "${PROJECT_BINARY_DIR}/changelog")
file(READ LICENSE-MIT ofc_mit)
string(REGEX REPLACE "\n\n" "\n.\n" ofc_mit "${ofc_mit}")
string(REGEX REPLACE "\n" "\n " ofc_mit "${ofc_mit}")
file(WRITE "${PROJECT_BINARY_DIR}/copyright"
  "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n\nFiles: *\n"
  "Copyright: 2026 The ofc authors\nLicense: Apache-2.0 or MIT\n\n"
  "License: Apache-2.0\n On Debian systems the text is in /usr/share/common-licenses/Apache-2.0.\n\n"
  "License: MIT\n ${ofc_mit}\n")
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER "${component}" name)
  install(FILES "${PROJECT_BINARY_DIR}/copyright" "${PROJECT_BINARY_DIR}/changelog.gz"
    DESTINATION "${CMAKE_INSTALL_DATAROOTDIR}/doc/${CPACK_DEBIAN_${name}_PACKAGE_NAME}"
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
# Needing no library, not even the one of C, is meant.
file(WRITE "${PROJECT_BINARY_DIR}/lintian-overrides"
  "libofc${ofc_abi}: shared-library-lacks-prerequisites [usr/lib/*/libofc.so.${PROJECT_VERSION}]\n")
install(FILES "${PROJECT_BINARY_DIR}/lintian-overrides"
  DESTINATION "${CMAKE_INSTALL_DATAROOTDIR}/lintian/overrides" RENAME "libofc${ofc_abi}"
  COMPONENT runtime EXCLUDE_FROM_ALL)

include(CPack)
