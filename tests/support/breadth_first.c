/* The engine's source a second time, under other names and without AMD. */
#undef PLUMB_HAVE_AMD
#define pe_pattern_find breadth_first_pattern
#define pe_pattern_mark_loaded breadth_first_mark_loaded
#define pe_pattern_mass_ratio breadth_first_mass_ratio

#include "breadth_first.h"

#include "sparse/pattern.c"
