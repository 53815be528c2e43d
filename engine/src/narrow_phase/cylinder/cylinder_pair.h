/* The signed distance of two cylinders. */
#ifndef PE_CYLINDER_PAIR_H
#define PE_CYLINDER_PAIR_H

#include "cylinder.h"

typedef enum pe_cylinder_meeting {
    PE_CAP_A, /* along a's axis */
    PE_CAP_B,
    PE_SIDES,  /* across both axes */
    PE_SIDE_A, /* a's side, b's rim */
    PE_SIDE_B,
    PE_RIMS
} pe_cylinder_meeting;

typedef struct pe_cylinder_gap {
    double distance; /* m; negative when they overlap */
    pe_vec3 normal;  /* unit, from a to b */
    pe_cylinder_meeting kind;
    pe_vec3 on_a; /* the point of a that realises the gap; where there are many, any one */
    double aside; /* m: that what it meets is beside b, for the bias, or for rounding */
} pe_cylinder_gap;

/* The gap of two cylinders in the same axes. A cap is left only for a meeting named later above
 * that is better by more than `bias`, in m. `size` is that of the smaller one. False as soon as
 * some direction separates them by more than `limit`. */
bool pe_cylinder_pair_gap(const pe_cylinder *a, const pe_cylinder *b, double size, double bias,
                          double limit, pe_cylinder_gap *gap);

#endif
