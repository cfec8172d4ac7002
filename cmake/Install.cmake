# Installs the library, its headers and package files, the command, and the pipelines with their sample dumps.
include(CMakePackageConfigHelpers)

set(GRAINVDB_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/grainvdb)
set(GRAINVDB_DATA_DIR ${CMAKE_INSTALL_DATADIR}/grainvdb)

set_target_properties(grainvdb PROPERTIES
  VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
install(TARGETS grainvdb EXPORT grainvdbTargets)
install(DIRECTORY include/grainvdb ${PROJECT_BINARY_DIR}/include/grainvdb
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")

# The command finds a shared library next to itself, wherever the prefix is moved to.
file(RELATIVE_PATH GRAINVDB_LIB_FROM_BIN ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR})
set_target_properties(grainvdb_cli PROPERTIES INSTALL_RPATH "$ORIGIN/${GRAINVDB_LIB_FROM_BIN}")
install(TARGETS grainvdb_cli)
install(FILES ${PROJECT_BINARY_DIR}/share/grainvdb.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${PROJECT_BINARY_DIR}/share/grainvdb DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)

install(EXPORT grainvdbTargets NAMESPACE grainvdb:: DESTINATION ${GRAINVDB_PACKAGE_DIR})
get_target_property(GRAINVDB_LIBRARY_TYPE grainvdb TYPE)
list(FILTER HDF5_C_LIBRARIES INCLUDE REGEX "/libhdf5[^/]*$")
get_filename_component(GRAINVDB_HDF5_LIBRARY_DIR "${HDF5_C_LIBRARIES}" DIRECTORY)
configure_package_config_file(cmake/grainvdbConfig.cmake.in grainvdbConfig.cmake
  INSTALL_DESTINATION ${GRAINVDB_PACKAGE_DIR} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(grainvdbConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/grainvdbConfig.cmake ${PROJECT_BINARY_DIR}/grainvdbConfigVersion.cmake
        DESTINATION ${GRAINVDB_PACKAGE_DIR})

# Side by side as in the source tree, so that the installed pipelines find their dumps.
install(DIRECTORY pipelines sample_dumps DESTINATION ${GRAINVDB_DATA_DIR})
install(DIRECTORY python/grainvdb DESTINATION ${GRAINVDB_DATA_DIR}/python FILES_MATCHING PATTERN "*.py" PATTERN "py.typed")
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN "*.json" EXCLUDE)
