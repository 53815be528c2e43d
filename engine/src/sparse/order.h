/* Elimination order of a sparse symmetric matrix. */
#ifndef PE_ORDER_H
#define PE_ORDER_H

#include "base/memory.h"

/* A graph of `count` vertices: the neighbours of i are adjacent[start[i]] .. adjacent[start[i + 1]
 * - 1], each edge at both ends, none twice, none to itself.
 *
 * Fills order (count): order[k] is eliminated k-th. Approximate minimum degree (Amestoy, Davis,
 * Duff 1996) where the engine was built with SuiteSparse's AMD, else breadth first from a vertex of
 * least degree, reversed (Cuthill and McKee 1969; George 1971). */
pe_status pe_order_find(int count, const int *start, const int *adjacent, pe_workspace work,
                        int *order, pe_error *error);

#endif
