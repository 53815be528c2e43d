# Debian packages, by cpack: libplumb0 (the shared engine), libplumb-dev (to build with it, and to write
# adapters), plumb (the program), and plumb-NAME for the adapter of each engine that is loaded. `compare/packaging/release` calls it.

# What Debian's policy asks of each package: its licence, and a changelog with the day of the release, which is
# that of CHANGELOG.md.
set(maintainer "The Plumb authors <plumb@packages.debian.org>")
set(own ${PROJECT_BINARY_DIR}/packaging)
file(READ LICENSE licence)
string(REGEX REPLACE "^MIT License\n\n[^\n]*\n\n" "" licence "${licence}")
string(REGEX REPLACE "\n$" "" licence "${licence}")
string(REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REPLACE "\n" "\n " licence " ${licence}")
configure_file(compare/packaging/copyright.in ${own}/copyright @ONLY)
file(STRINGS CHANGELOG.md released REGEX "^## .${PLUMB_VERSION}. - [0-9-]+$")
string(REGEX REPLACE ".* - " "" released "${released}")
execute_process(COMMAND date -u -R -d "${released}" OUTPUT_VARIABLE released OUTPUT_STRIP_TRAILING_WHITESPACE)
file(WRITE ${own}/changelog "plumb (${PLUMB_VERSION}) unstable; urgency=medium

  * Release ${PLUMB_VERSION}: see /usr/share/doc/plumb/CHANGELOG.md.

 -- ${maintainer}  ${released}
")
execute_process(COMMAND gzip -9nkf ${own}/changelog)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME plumb)
set(CPACK_PACKAGE_CONTACT ${maintainer})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL libplumb0 libplumb-dev plumb)
get_property(modules GLOBAL PROPERTY PLUMB_PRESENT_MODULES)
list(TRANSFORM modules PREPEND plumb- OUTPUT_VARIABLE module_packages)
list(APPEND CPACK_COMPONENTS_ALL ${module_packages})
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")

# plumb_package(COMPONENT SECTION SUMMARY DESCRIPTION)
macro(plumb_package component section summary description)
  string(TOUPPER ${component} upper)
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${summary}\n${description}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${component})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  install(FILES ${own}/changelog.gz ${own}/copyright
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${component} COMPONENT ${component})
endmacro()

plumb_package(libplumb0 libs "rigid-body physics engine, shared library"
"Plumb's engine simulates rigid bodies with contact and friction: boxes,
spheres, capsules, cylinders, convex hulls and triangle meshes. The same calls
give the same bits on every machine and with any number of threads.")
plumb_package(libplumb-dev libdevel "rigid-body physics engine, development files"
"Headers, static library, and files for CMake and pkg-config, to build programs
with Plumb's engine, and adapters by which plumb compares other engines.")
plumb_package(plumb science "measures the accuracy of rigid-body physics engines"
"Plumb runs the same scenes (stacks, friction slopes, collapsing walls and
many more) on several rigid-body physics engines, and compares each result
with the right answer. Its reports say how accurate each engine is and what
that costs; its gate fails a build in which an engine got worse. Its own
engine and those of Debian's libraries are linked; others are loaded or run as
programs.")
foreach(engine IN LISTS modules)
  plumb_member(title ${engine} title)
  plumb_package(plumb-${engine} science "adapter of the ${title} physics engine for plumb"
"With this package, plumb compares ${title}, too.")
  string(TOUPPER ${engine} upper)
  set(CPACK_DEBIAN_PLUMB-${upper}_PACKAGE_DEPENDS "plumb (= ${PLUMB_VERSION})")
endforeach()
set(CPACK_DEBIAN_LIBPLUMB-DEV_PACKAGE_DEPENDS "libplumb0 (= ${PLUMB_VERSION}), libsuitesparse-dev")
list(JOIN module_packages ", " module_packages)
set(CPACK_DEBIAN_PLUMB_PACKAGE_SUGGESTS "chromium, libplumb-dev, nodejs, npm, ${module_packages}, python3-pandas")
string(REPLACE ", ," "," CPACK_DEBIAN_PLUMB_PACKAGE_SUGGESTS "${CPACK_DEBIAN_PLUMB_PACKAGE_SUGGESTS}")
set(CPACK_DEBIAN_LIBPLUMB0_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/triggers)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/lintian_overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
  RENAME libplumb0 COMPONENT libplumb0)
include(CPack)
