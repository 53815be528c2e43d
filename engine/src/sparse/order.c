#include "order.h"

#include <string.h>

#ifdef PLUMB_HAVE_AMD
#include <suitesparse/amd.h>

pe_status pe_order_find(int count, const int *start, const int *adjacent, pe_workspace work,
                        int *order, pe_error *error)
{
    size_t n = (size_t)count, edges = (size_t)start[count];
    size_t room = edges + edges / 5 + n + 1;
    int *p = pe_take(work, n + 1, sizeof *p), *length = pe_take(work, n + 1, sizeof *length);
    int *list = pe_take(work, room, sizeof *list);
    int *space = pe_take(work, 6 * n + 1, sizeof *space);
    if (p == NULL || length == NULL || list == NULL || space == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to order %d bodies", count);
    }
    memcpy(p, start, (n + 1) * sizeof *p);
    memcpy(list, adjacent, edges * sizeof *list);
    for (size_t i = 0; i < n; ++i) {
        length[i] = start[i + 1] - start[i];
    }
    /* Unlike amd_order it takes its memory from us, and the pattern is known to be clean. */
    amd_2(count, p, list, length, (int)room, (int)edges, space, space + n, order, space + 2 * n,
          space + 3 * n, space + 4 * n, space + 5 * n, NULL, NULL);
    return PE_OK;
}

#else

pe_status pe_order_find(int count, const int *start, const int *adjacent, pe_workspace work,
                        int *order, pe_error *error)
{
    char *seen = pe_take(work, (size_t)count + 1, sizeof *seen);
    if (seen == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory to order %d bodies", count);
    }
    memset(seen, 0, (size_t)count);
    int queued = 0;
    for (int next = 0; next < count; ++next) {
        if (next == queued) { /* a part of the graph not reached yet: begin at its least degree */
            int root = -1;
            for (int i = 0; i < count; ++i) {
                if (!seen[i] &&
                    (root < 0 || start[i + 1] - start[i] < start[root + 1] - start[root])) {
                    root = i;
                }
            }
            seen[root] = 1;
            order[queued++] = root;
        }
        int i = order[next];
        for (int k = start[i]; k < start[i + 1]; ++k) {
            if (!seen[adjacent[k]]) {
                seen[adjacent[k]] = 1;
                order[queued++] = adjacent[k];
            }
        }
    }
    for (int i = 0; i < count / 2; ++i) {
        int swapped = order[i];
        order[i] = order[count - 1 - i];
        order[count - 1 - i] = swapped;
    }
    return PE_OK;
}

#endif
