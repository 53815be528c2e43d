# Adds the folder of each native engine, whose CMakeLists.txt calls plumb_engine where it finds the engine, and makes the
# table of built-in engines. The global property PLUMB_PRESENT_ENGINES has the names of those that were found,
# PLUMB_PRESENT_MODULES of those that are shared objects.
#
# plumb_engine(VERSION V [LIBRARIES ...] [DEFINITIONS ...] [OPTIONS ...]) builds an adapter of all C and C++ files of
# the folder and of its engine.json (describe.cmake): into plumb_adapters, or as the shared object plumb_NAME, which is loaded when the engine is asked for. Its files know
# the version as PLUMB_NAME_VERSION. OPTIONS are of its C++ files: what not to warn about in the engine's headers.
include(adapters/describe.cmake)

function(plumb_engine)
  cmake_parse_arguments(ENGINE "" "VERSION" "LIBRARIES;DEFINITIONS;OPTIONS" ${ARGN})
  get_filename_component(name ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  plumb_member(adapter ${name} adapter)
  set(target plumb_adapters)
  if(adapter STREQUAL "module")
    set(target plumb_${name})
    add_library(${target} MODULE)
    set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME ${name}
      LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib/plumb)
    target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/compare/include ${PROJECT_SOURCE_DIR}/compare)
    target_compile_definitions(${target} PRIVATE _GNU_SOURCE)
    target_link_libraries(${target} PRIVATE plumb_scenarios plumb_flags m)
    set_property(GLOBAL APPEND PROPERTY PLUMB_PRESENT_MODULES ${name})
  endif()
  plumb_describe(${name})
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR})
  string(TOUPPER ${name} upper)
  file(GLOB sources CONFIGURE_DEPENDS *.c *.cpp)
  target_sources(${target} PRIVATE ${sources})
  target_link_libraries(${target} PRIVATE ${ENGINE_LIBRARIES})
  target_compile_definitions(${target} PRIVATE PLUMB_${upper}_VERSION="${ENGINE_VERSION}" ${ENGINE_DEFINITIONS})
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  if(sources)
    set_source_files_properties(${sources} TARGET_DIRECTORY ${target} PROPERTIES
      COMPILE_OPTIONS "${ENGINE_OPTIONS}")
  endif()
  set_property(GLOBAL APPEND PROPERTY PLUMB_PRESENT_ENGINES ${name})
  message(STATUS "engine ${name}: ${ENGINE_VERSION}")
endfunction()

set(declarations)
set(rows)
foreach(name IN LISTS PLUMB_ENGINES)
  plumb_member(adapter ${name} adapter)
  plumb_member(language ${name} language)
  if(adapter STREQUAL "script" OR (adapter STREQUAL "module" AND NOT PLUMB_ADAPTER_MODULES))
  elseif(language STREQUAL "C++" AND NOT CMAKE_CXX_COMPILER)
    message(STATUS "engine ${name}: left out, for there is no C++ compiler, or no engine for one (Debian package g++)")
  else()
    add_subdirectory(adapters/${name})
  endif()
  get_property(present GLOBAL PROPERTY PLUMB_PRESENT_ENGINES)

  foreach(key script libraries family npm)
    plumb_member(${key} ${name} ${key})
  endforeach()
  plumb_debian_packages(debian ${name})
  list(JOIN debian " " debian)
  set(row ".name = \"${name}\", .package = \"${debian}${npm}\", .libraries = \"${libraries}\"")
  if(family)
    string(APPEND row ", .family = \"${family}\"")
  endif()
  if(adapter STREQUAL "script")
    string(APPEND row ", .script = \"${script}\"")
  elseif(adapter STREQUAL "module")
    string(APPEND row ", .is_module = true")
  elseif(name IN_LIST present)
    string(APPEND declarations "const pl_engine *pl_engine_${name}(void);\n")
    string(APPEND row ", .entry = pl_engine_${name}")
  endif()
  string(APPEND rows "    {${row}},\n")
  plumb_member(reference ${name} reference)
  if(reference)
    string(APPEND declarations "const char pl_reference_engine[] = \"${reference}\";\n")
  endif()
  if(debian AND NOT name IN_LIST present)
    message(STATUS "engine ${name}: absent (Debian: ${debian})")
  endif()
endforeach()
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/built_in_table.c @ONLY CONTENT
"#include \"adapters/built_in.h\"

${declarations}
const pl_built_in pl_built_in_table[] = {
${rows}};

const int pl_built_in_count = sizeof pl_built_in_table / sizeof *pl_built_in_table;
_Static_assert(sizeof pl_built_in_table / sizeof *pl_built_in_table <= PL_MOST_BUILT_IN,
               \"PL_MOST_BUILT_IN is too small\");
")
target_sources(plumb_adapters PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/built_in_table.c)
