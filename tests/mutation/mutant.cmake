# Included by the project that mutate.py builds: every library gets the variable that activates a mutation.
add_library(plumb_mutant STATIC ${PROJECT_SOURCE_DIR}/mutant.c)
set_target_properties(plumb_mutant PROPERTIES POSITION_INDEPENDENT_CODE ON)
link_libraries(plumb_mutant)
