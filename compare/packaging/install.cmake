# Installs the program with what it loads, completion, manual, documentation and examples, and the headers of
# the engine ABI. The engine installs itself (engine/cmake/install.cmake).
set(documentation ${CMAKE_INSTALL_DATADIR}/doc)

install(TARGETS plumb RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT plumb)
get_property(web_files GLOBAL PROPERTY PLUMB_WEB_FILES)
install(PROGRAMS compare/adapters/web/get-engines DESTINATION ${CMAKE_INSTALL_LIBDIR}/plumb/web COMPONENT plumb)
list(FILTER web_files EXCLUDE REGEX "/get-engines$")
install(FILES ${web_files} DESTINATION ${CMAKE_INSTALL_LIBDIR}/plumb/web COMPONENT plumb)
get_property(modules GLOBAL PROPERTY PLUMB_PRESENT_MODULES)
foreach(engine IN LISTS modules)
  install(TARGETS plumb_${engine} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/plumb COMPONENT plumb-${engine})
endforeach()

install(FILES compare/completion/plumb.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  RENAME plumb COMPONENT plumb)
install(FILES compare/completion/_plumb DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT plumb)
install(FILES compare/completion/plumb.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT plumb)
install(FILES ${PROJECT_BINARY_DIR}/compare/plumb.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT plumb)

# Pages lie as in the source, so that the links between them work.
file(GLOB_RECURSE pages RELATIVE ${PROJECT_SOURCE_DIR} engine/*.md scenarios/*.md compare/*.md compare/report/*.png)
list(FILTER pages EXCLUDE REGEX "^compare/(template/|state_notes)")
foreach(page README.md CHANGELOG.md ${pages})
  get_filename_component(folder ${page} DIRECTORY)
  install(FILES ${page} DESTINATION ${documentation}/plumb/${folder} COMPONENT plumb)
endforeach()
install(DIRECTORY compare/examples DESTINATION ${documentation}/plumb/compare COMPONENT plumb
  PATTERN README.md EXCLUDE)

install(TARGETS plumb_engine_abi EXPORT plumb)
install(FILES compare/include/plumb/engine_abi.h compare/include/plumb/adapter_helpers.h
  scenarios/include/plumb/scene_data.h scenarios/include/plumb/status.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/plumb COMPONENT libplumb-dev)
file(RELATIVE_PATH PLUMB_PC_PREFIX ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
configure_file(compare/packaging/plumb-engine-abi.pc.in plumb-engine-abi.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/plumb-engine-abi.pc
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT libplumb-dev)
install(DIRECTORY engine/examples/ DESTINATION ${documentation}/libplumb-dev/examples/engine COMPONENT libplumb-dev)
install(FILES compare/template/CMakeLists.txt compare/template/engine.c compare/template/sphere_world.c
  compare/template/sphere_world.h
  DESTINATION ${documentation}/libplumb-dev/examples/adapter COMPONENT libplumb-dev)
