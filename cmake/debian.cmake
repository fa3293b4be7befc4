# One Debian package of library, program and Python package: `cpack -G DEB` in a build folder; .ci/package calls it.
set(CPACK_PACKAGE_CONTACT "The conelane authors <noreply@conelane.invalid>") # Debian wants an address; the project has none
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGE_DESCRIPTION "The program, the library for C++ and the Python package.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libeigen3-dev")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-matplotlib")
if(conelane_python)
    math(EXPR next "${Python_VERSION_MINOR} + 1") # no stable ABI: the module is for one version of Python
    string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS ", python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy")
endif()
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/conelane RENAME copyright)
include(CPack)
