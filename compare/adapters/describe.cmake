# Makes constants of the engine ABI of `hello` of NAME/engine.json, in which an engine says what it is in the words of plumb.engine/1
# (process/PROTOCOL.md), so that its adapter has functions alone.

# The member of `json` at a path as C has it: a text with its quotes, a number, true or false; `otherwise` where there is none.
function(plumb_c out json otherwise)
  string(JSON type ERROR_VARIABLE fault TYPE "${json}" ${ARGN})
  set(value ${otherwise})
  if(NOT fault)
    string(JSON value GET "${json}" ${ARGN})
    if(type STREQUAL "STRING")
      string(REGEX REPLACE "([\\\"])" "\\\\\\1" value "${value}")
      set(value "\"${value}\"")
    elseif(type STREQUAL "BOOLEAN")
      string(REPLACE "OFF" "false" value "${value}")
      string(REPLACE "ON" "true" value "${value}")
    endif()
  endif()
  set(${out} "${value}" PARENT_SCOPE)
endfunction()

# The indices of the array of `json` at a path; none where there is no array.
function(plumb_indices out json)
  string(JSON count ERROR_VARIABLE fault LENGTH "${json}" ${ARGN})
  set(indices)
  if(NOT fault AND count GREATER 0)
    math(EXPR last "${count} - 1")
    foreach(i RANGE ${last})
      list(APPEND indices ${i})
    endforeach()
  endif()
  set(${out} "${indices}" PARENT_SCOPE)
endfunction()

# A word, without quotes, as an enumerator.
function(plumb_enumerator out prefix word)
  string(REGEX REPLACE "[^A-Za-z0-9]+" "_" word "${word}")
  string(REGEX REPLACE "^_|_$" "" word "${word}")
  string(TOUPPER "${prefix}_${word}" word)
  set(${out} ${word} PARENT_SCOPE)
endfunction()

# The words of an array as bits of the engine ABI.
function(plumb_bits out prefix json)
  set(bits 0)
  plumb_indices(indices "${json}" ${ARGN})
  foreach(i IN LISTS indices)
    string(JSON word GET "${json}" ${ARGN} ${i})
    plumb_enumerator(bit ${prefix} "${word}")
    string(APPEND bits " | ${bit}")
  endforeach()
  set(${out} "${bits}" PARENT_SCOPE)
endfunction()

# The members of an item as the beginning of a row of a table: MEMBER, or MEMBER=WHAT IT IS WHERE THERE IS NONE.
function(plumb_row out json)
  set(row)
  foreach(member IN LISTS ARGN)
    string(REGEX MATCH "^([a-z_]+)=?(.*)$" member "${member}")
    set(key ${CMAKE_MATCH_1})
    plumb_c(value "${json}" "${CMAKE_MATCH_2}" ${key})
    string(APPEND row "${value}, ")
  endforeach()
  set(${out} "${row}" PARENT_SCOPE)
endfunction()

# Writes NAME_description.h for `hello` of the description of the engine NAME.
function(plumb_describe name)
  set(hello "${PLUMB_HELLO_${name}}")
  foreach(key profiles options sources)
    plumb_indices(indices_${key} "${hello}" ${key})
  endforeach()
  set(options)
  set(option_rows)
  foreach(i IN LISTS indices_options)
    string(JSON item GET "${hello}" options ${i})
    string(JSON option GET "${item}" name)
    list(APPEND options ${option})
    plumb_row(row "${item}" name value min max integer=false unit="1" help code=NULL)
    plumb_bits(tuned "1u << PROFILE" "${item}" tune profiles)
    foreach(key min max logarithmic)
      plumb_c(tune_${key} "${item}" 0 tune ${key})
    endforeach()
    string(APPEND option_rows "    {${row}${tuned}, ${tune_min}, ${tune_max}, ${tune_logarithmic}},\n")
  endforeach()
  list(TRANSFORM options REPLACE "(.+)" "OPTION_\\1, ")
  list(JOIN options "" option_names)
  string(TOUPPER "${option_names}" option_names)

  set(profile_names)
  set(profile_rows)
  set(value_rows)
  foreach(i IN LISTS indices_profiles)
    string(JSON item GET "${hello}" profiles ${i})
    string(JSON profile GET "${item}" name)
    plumb_enumerator(profile PROFILE "${profile}")
    string(APPEND profile_names "${profile}, ")
    plumb_row(row "${item}" name help in_default_comparison=false step_code=NULL)
    string(APPEND profile_rows "    {${row}},\n")
    set(row)
    foreach(k IN LISTS indices_options)
      string(JSON option GET "${hello}" options ${k} name)
      plumb_c(value "${item}" NAN values ${option})
      string(APPEND row "${value}, ")
    endforeach()
    string(APPEND value_rows "        {${row}},\n")
  endforeach()

  set(source_rows)
  foreach(i IN LISTS indices_sources)
    string(JSON item GET "${hello}" sources ${i})
    string(JSON profile GET "${item}" profile)
    plumb_enumerator(profile PROFILE "${profile}")
    plumb_row(row "${item}" option=NULL text)
    string(APPEND source_rows "    {${profile}, ${row}},\n")
  endforeach()
  list(LENGTH indices_sources source_count)
  if(source_count EQUAL 0)
    set(source_rows "    {0, NULL, NULL}\n")
  endif()

  foreach(key integrator gyroscopic)
    string(JSON word GET "${hello}" ${key})
    plumb_enumerator(${key} PL_${key} "${word}")
  endforeach()
  plumb_bits(capabilities PL_NEEDS "${hello}" capabilities)
  plumb_bits(contacts PL_CONTACTS "${hello}" contacts)
  plumb_row(texts "${hello}" description residual_unit=NULL)
  string(REGEX REPLACE ", $" "" texts "${texts}")
  string(TOUPPER ${name} upper)
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${name}_description.h @ONLY CONTENT
"/* What ${name}/engine.json says of `hello`. */
#ifndef PLUMB_${upper}_DESCRIPTION_H
#define PLUMB_${upper}_DESCRIPTION_H

#include \"plumb/engine_abi.h\"

#include <math.h>

/* The indices of the profiles and of the options. */
enum { ${profile_names}PROFILE_COUNT };
enum { ${option_names}OPTION_COUNT };

static const pl_engine_profile engine_profiles[PROFILE_COUNT] = {
${profile_rows}};

static const pl_engine_option engine_options[OPTION_COUNT] = {
${option_rows}};

static const pl_engine_source engine_sources[] = {
${source_rows}};

/* Overwrites the values that a profile changes. */
static inline void engine_profile_values(int profile, double *values)
{
    static const double changed[PROFILE_COUNT][OPTION_COUNT] = {
${value_rows}    };
    for (int i = 0; i < OPTION_COUNT; ++i) {
        values[i] = isnan(changed[profile][i]) ? values[i] : changed[profile][i];
    }
}

/* The initializers of a pl_engine, but for its functions. */
#define ENGINE_DESCRIPTION sizeof(pl_engine), PL_ENGINE_ABI_VERSION, \"${name}\", PLUMB_${upper}_VERSION, \\
    ${texts}, \\
    ${capabilities}, \\
    ${contacts}, \\
    PL_PRECISION_DOUBLE, ${integrator}, ${gyroscopic}, 1, \\
    engine_profiles, PROFILE_COUNT, engine_options, OPTION_COUNT, \\
    .sources = engine_sources, .source_count = ${source_count}

#endif
")
endfunction()
