# The language standard of the folder that includes this, and the target that every target of ours links
# privately: the warnings, and arithmetic that is the same bits under every compiler and optimisation level.
set(CMAKE_C_STANDARD 17)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

option(PLUMB_WERROR "Treat warnings as errors" OFF)

if(NOT TARGET plumb_flags)
  # A contracted multiply-add rounds once where two operations round twice, so contraction would make results
  # depend on what the compiler chose to fuse. gcc 12 contracts pairs of a sum and a difference in its SLP
  # vectoriser even so, where the processor has FMA.
  add_library(plumb_flags INTERFACE)
  target_compile_options(plumb_flags INTERFACE
    -ffp-contract=off
    $<$<OR:$<COMPILE_LANG_AND_ID:C,GNU>,$<COMPILE_LANG_AND_ID:CXX,GNU>>:-fno-tree-slp-vectorize>
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wundef -Wvla -Wformat=2
    # Under clang this one rejects every `double x = NAN`: glibc's NAN is a float.
    $<$<COMPILE_LANG_AND_ID:C,GNU>:-Wdouble-promotion>
    $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes -Wmissing-prototypes>
    $<$<BOOL:${PLUMB_WERROR}>:-Werror>)
endif()
