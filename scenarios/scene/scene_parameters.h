/* Parameters of scene files: numbers that the file's other numbers may name, alone or in expressions
 * (base/expression.h): "friction": "mu", "distance": "v*v/(2*mu*9.81)". */
#ifndef PLUMB_SCENE_PARAMETERS_H
#define PLUMB_SCENE_PARAMETERS_H

#include "base/json_field.h"
#include "scene_fields.h"

/* The parameters of a scene file, in its order. */
typedef struct pl_scene_parameters {
    pl_scene_parameter items[PL_MAX_SCENE_PARAMETERS];
    int count;
} pl_scene_parameters;

/* Reads the parameters of a scene; without the key, their count is 0. False with a diagnostic when a name or a
 * member is not right, or a value is out of its range. */
bool pl_read_parameters(const json_t *scene, pl_scene_parameters *parameters,
                        pl_diagnostic *diagnostic);

/* Puts numbers in the place of the expressions in all fields of `scene` that take numbers. `values`
 * are those of the parameters, in their order; NULL: their defaults. False with a diagnostic when an
 * expression has no value, and when a parameter is used nowhere. */
bool pl_substitute_parameters(json_t *scene, const pl_scene_parameters *parameters,
                              const double *values, pl_diagnostic *diagnostic);

#endif
