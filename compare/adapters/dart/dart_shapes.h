/* The shapes and the collision detectors of a DART world; for C++ only. */
#ifndef PLUMB_DART_SHAPES_H
#define PLUMB_DART_SHAPES_H

#include "dart_c.h"

#include <Eigen/Geometry>
#include <dart/collision/SmartPointer.hpp>
#include <dart/dynamics/SmartPointer.hpp>

/* Why the detector of a world cannot have shapes of this kind; null when it can. */
const char *pl_dart_why_not(const pl_dart_world_def &def, pl_shape_kind kind);

/* The shape that the detector gets, of a kind that it can have, in the principal frame. */
dart::dynamics::ShapePtr pl_dart_make_shape(const pl_dart_world_def &def,
                                            const pl_engine_setup &setup, const pl_shape &shape);

/* The pose of a body's principal frame at the start, m; of a plane, that of its shape. */
Eigen::Isometry3d pl_dart_pose(const pl_dart_world_def &def, const pl_engine_setup &setup,
                               const pl_body &body);

/* The detector; null where this build has it not. */
dart::collision::CollisionDetectorPtr pl_dart_make_detector(const pl_dart_world_def &def);

#endif
