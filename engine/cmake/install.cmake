# Installs the libraries, their headers, and what CMake and pkg-config need to find them.
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/plumb)

install(TARGETS plumb_engine_shared EXPORT plumb
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libplumb0 NAMELINK_COMPONENT libplumb-dev)
install(TARGETS plumb_engine EXPORT plumb
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT libplumb-dev)
install(FILES include/plumb/contact_problem.h include/plumb/engine.h include/plumb/version.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/plumb COMPONENT libplumb-dev)
install(EXPORT plumb NAMESPACE plumb:: FILE plumbTargets.cmake
  DESTINATION ${package_folder} COMPONENT libplumb-dev)

configure_package_config_file(cmake/plumbConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/plumbConfig.cmake
  INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/plumbConfigVersion.cmake
  COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/plumbConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/plumbConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT libplumb-dev)

# What a static link needs besides libplumb.a.
set(PLUMB_PRIVATE_LIBRARIES "-lm -pthread")
if(amd_link)
  string(PREPEND PLUMB_PRIVATE_LIBRARIES "-lamd ")
endif()
# Relative to the file, so that an installation may be moved.
file(RELATIVE_PATH PLUMB_PC_PREFIX ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
configure_file(cmake/plumb.pc.in plumb.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/plumb.pc
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT libplumb-dev)
