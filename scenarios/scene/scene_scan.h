/* Bodies of the usual form from their text, which is several times as fast as by way of a tree. */
#ifndef PLUMB_SCENE_SCAN_H
#define PLUMB_SCENE_SCAN_H

#include "base/json_scan.h"
#include "plumb/scene.h"
#include "scene_read_shape.h"

/* Reads a dynamic body that has a mass, and no hull, mesh or forces of its own. Its material is -1
 * where it names none. False for every other body and every fault; the scanner is then anywhere. The
 * numbers are those of the tree, to the bit. */
bool pl_scan_body(pl_json_scanner *scanner, const pl_shape_reader *shapes, pl_body *body);

#endif
