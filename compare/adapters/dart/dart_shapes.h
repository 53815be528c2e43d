/* The shapes and the collision detectors of a DART world. */
#ifndef PLUMB_DART_SHAPES_H
#define PLUMB_DART_SHAPES_H

#include "adapters/native.h"

#include <Eigen/Geometry>
#include <dart/collision/SmartPointer.hpp>
#include <dart/dynamics/SmartPointer.hpp>

/* A vector of DART's. */
inline Eigen::Vector3d vector(const double v[3])
{
    return Eigen::Vector3d(v[0], v[1], v[2]);
}

/* PL_UNSUPPORTED, with the reason, where the detector of the profile cannot have the scene's shapes. */
pl_status pl_dart_check_shapes(const pl_engine_setup &setup, pl_error *error);

/* The shape that the detector gets, of a kind that it can have, in the principal frame. */
dart::dynamics::ShapePtr pl_dart_make_shape(const pl_engine_setup &setup, const pl_shape &shape);

/* The pose of a body's principal frame at the start, m; of a plane, that of its shape. */
Eigen::Isometry3d pl_dart_pose(const pl_engine_setup &setup, const pl_body &body);

/* The detector; null where this build has it not. */
dart::collision::CollisionDetectorPtr pl_dart_make_detector(const pl_engine_setup &setup);

#endif
