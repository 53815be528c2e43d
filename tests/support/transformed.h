/* Scenes transformed, for tests of the checks that need no reference. */
#ifndef PLUMB_TEST_TRANSFORMED_H
#define PLUMB_TEST_TRANSFORMED_H

#include "studies/metamorphic/metamorphic.h"

/* The test fails where there is no transforming it. The caller frees the scene. */
pl_scene transformed(const pl_transform *transform, const pl_scene *from);

/* The check's transform, or the identity where it does not apply. */
pl_transform transform_of(const pl_check *check, const pl_scene *scene);

/* Every component to absolute + relative |expected|. */
void assert_vectors(const double actual[3], const double expected[3], double absolute,
                    double relative);

#endif
