/* The engine's sources once more, under other names and without AMD. */
#undef PLUMB_HAVE_AMD
#define pe_order_find breadth_first_order
#define pe_pattern_find breadth_first_pattern
#define pe_pattern_mark_loaded breadth_first_mark_loaded
#define pe_pattern_mass_ratio breadth_first_mass_ratio

#include "breadth_first.h"

#include "sparse/order.c"
#include "sparse/pattern.c"
