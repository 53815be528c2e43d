/* A tree of boxes around the triangles of a mesh, which finds those in a place. */
#ifndef PLUMB_MESH_TREE_H
#define PLUMB_MESH_TREE_H

#include "base/diagnostic.h"

#include <stdbool.h>

/* A node: the triangles order[begin .. end) and the box around them. Its first child follows it. */
typedef struct pl_mesh_node {
    double low[3], high[3];
    int begin, end;
    int second; /* the other child; 0: a leaf */
} pl_mesh_node;

/* The tree. */
typedef struct pl_mesh_tree {
    const double (*vertices)[3]; /* borrowed, as the triangles */
    const int (*triangles)[3];
    int *order;
    double (*middle)[3]; /* of the triangles' boxes, twice */
    pl_mesh_node *nodes;
    int node_count;
} pl_mesh_tree;

/* Makes the tree of at least one triangle. False when out of memory. O(n log n). */
bool pl_mesh_tree_create(const double (*vertices)[3], const int (*triangles)[3], int triangle_count,
                         pl_mesh_tree *tree);

/* Frees the tree's memory. */
void pl_mesh_tree_free(pl_mesh_tree *tree);

/* The box around triangle t. */
void pl_mesh_box(const pl_mesh_tree *tree, int t, double low[3], double high[3]);

/* What is nearer than this, m, touches: 1e-9 of the mesh's size, and the rounding of its
 * coordinates. */
double pl_mesh_tolerance(const pl_mesh_tree *tree);

/* How many triangles a check of a mesh may look at near others, so that its time is bounded: a fan
 * of 4096 triangles has fewer, with one corner or the middle common. */
long pl_mesh_most_near(int triangle_count);

/* Reports that there are more. Returns false. */
bool pl_mesh_diagnose_near(pl_diagnostic *diagnostic);

enum { PL_MESH_DEEPEST = 64 };

/* A search for all triangles whose boxes touch a box. */
typedef struct pl_mesh_search {
    const pl_mesh_tree *tree;
    double low[3], high[3];
    int stack[PL_MESH_DEEPEST], depth;
    int at, end; /* of the leaf that is being searched */
} pl_mesh_search;

/* Begins a search. */
pl_mesh_search pl_mesh_search_begin(const pl_mesh_tree *tree, const double low[3],
                                    const double high[3]);

/* The next triangle; -1: there is none. */
int pl_mesh_search_next(pl_mesh_search *search);

#endif
