#include "fuzz.h"

#include <stdio.h>
#include <stdlib.h>

void fuzz_check(bool holds, const char *law)
{
    if (!holds) {
        fprintf(stderr, "broken: %s\n", law);
        abort();
    }
}
