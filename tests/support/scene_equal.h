/* Scenes read from text, and equality of scenes, number for number. */
#ifndef PLUMB_TEST_SCENE_EQUAL_H
#define PLUMB_TEST_SCENE_EQUAL_H

#include "plumb/scene.h"

/* Reads a scene from JSON. The test fails where it is not valid. */
pl_scene read_scene(const char *text);

/* Fails unless every field of both is the same: doubles as bits, so that 0 and -0 differ. */
void assert_same_scene(const pl_scene *actual, const pl_scene *expected);

/* The same for two bodies. */
void assert_same_body(const pl_body *actual, const pl_body *expected);

#endif
