/* A scene file that has every object and every key of the format, and text that is not ASCII. */
#ifndef PLUMB_TEST_SAMPLE_SCENE_H
#define PLUMB_TEST_SAMPLE_SCENE_H

extern const char sample_scene[];

#endif
