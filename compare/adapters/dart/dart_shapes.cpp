/* Planes: OdeCollisionDetector has half-spaces, and so have FCL's primitive shapes. Where FCL has
 * triangles, a PlaneShape becomes a sheet of 1000 m by 1000 m across the y axis, whatever its
 * normal, and DARTCollisionDetector has no planes: there a box stands for it.
 *
 * FCL's triangles: a sphere is a polyhedron of 58 corners on it, 8 around and 7 high, and a
 * cylinder has 16 sides (FCLCollisionDetector.cpp, 6.12.1), also with primitive shapes.
 *
 * Hulls and meshes are MeshShapes, whose vertices Assimp keeps as floats, here in the principal
 * frame. DART 6.12 has no convex hulls of points. Capsules exist for ODE only: FCLCollisionDetector
 * would put a sphere of 0.1 m in their place. */
#include "dart_shapes.h"

#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <dart/collision/dart/DARTCollisionDetector.hpp>
#include <dart/collision/fcl/FCLCollisionDetector.hpp>
#ifdef PLUMB_HAVE_DART_ODE
#include <dart/collision/ode/OdeCollisionDetector.hpp>
#endif
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/CapsuleShape.hpp>
#include <dart/dynamics/CylinderShape.hpp>
#include <dart/dynamics/MeshShape.hpp>
#include <dart/dynamics/PlaneShape.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart_description.h>

#include <cmath>
#include <memory>

namespace collision = dart::collision;
namespace dynamics = dart::dynamics;

namespace {

/* DART's collision detectors, but for Bullet's. */
enum class Detector { fcl, ode, own };

Detector detector_of(const pl_engine_setup &setup)
{
    switch (setup.profile) {
    case PROFILE_ODE_COLLISION:
    case PROFILE_RECOMMENDED:
        return Detector::ode;
    case PROFILE_DART_COLLISION:
        return Detector::own;
    default:
        return Detector::fcl;
    }
}

bool has_fcl_primitives(const pl_engine_setup &setup)
{
    return setup.values[OPTION_FCL_PRIMITIVES] > 0;
}

dynamics::ShapePtr make_mesh(const pl_polyhedron &solid)
{
    const auto vertex_count = static_cast<unsigned int>(solid.vertex_count);
    const auto face_count = static_cast<unsigned int>(solid.triangle_count);
    /* Owned by the scene, which the shape frees. */
    auto *mesh = new aiMesh;
    mesh->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
    mesh->mNumVertices = vertex_count;
    mesh->mVertices = new aiVector3D[vertex_count];
    mesh->mNormals = new aiVector3D[vertex_count];
    for (unsigned int i = 0; i < vertex_count; ++i) {
        double v[3];
        pl_vertex_in_principal(&solid, static_cast<int>(i), v);
        mesh->mVertices[i] = aiVector3D(static_cast<ai_real>(v[0]), static_cast<ai_real>(v[1]),
                                        static_cast<ai_real>(v[2]));
    }
    mesh->mNumFaces = face_count;
    mesh->mFaces = new aiFace[face_count];
    for (unsigned int i = 0; i < face_count; ++i) {
        const int *corners = solid.triangles[i];
        aiFace &face = mesh->mFaces[i];
        face.mNumIndices = 3;
        face.mIndices = new unsigned int[3];
        const aiVector3D &p = mesh->mVertices[corners[0]];
        const aiVector3D normal =
            (mesh->mVertices[corners[1]] - p) ^ (mesh->mVertices[corners[2]] - p);
        for (int k = 0; k < 3; ++k) {
            face.mIndices[k] = static_cast<unsigned int>(corners[k]);
            mesh->mNormals[corners[k]] += normal;
        }
    }
    for (unsigned int i = 0; i < vertex_count; ++i) {
        mesh->mNormals[i].NormalizeSafe();
    }
    auto *scene = new aiScene;
    scene->mRootNode = new aiNode;
    scene->mNumMeshes = 1;
    scene->mMeshes = new aiMesh *[1] { mesh };
    return std::make_shared<dynamics::MeshShape>(Eigen::Vector3d::Ones(), scene);
}

bool has_planes(const pl_engine_setup &setup)
{
    return detector_of(setup) == Detector::ode ||
           (detector_of(setup) == Detector::fcl && has_fcl_primitives(setup));
}

/* Half the width of the box that stands for a plane, m. */
double plane_reach(const pl_engine_setup &setup)
{
    return (vector(setup.upper) - vector(setup.lower)).norm() / 2;
}

} // namespace

pl_status pl_dart_check_shapes(const pl_engine_setup &setup, pl_error *error)
{
    const Detector detector = detector_of(setup);
    if (has_fcl_primitives(setup) && detector != Detector::fcl) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "dart:%s has not FCL's shapes: it has no fcl_primitives",
                       engine_profiles[setup.profile].name);
    }
    for (int i = 0; i < setup.scene->body_count; ++i) {
        const pl_shape_kind kind = setup.scene->bodies[i].shape.kind;
        const bool simple =
            kind == PL_SHAPE_SPHERE || kind == PL_SHAPE_BOX || kind == PL_SHAPE_PLANE;
        if (detector == Detector::own && !simple) {
            return pl_fail(error, PL_UNSUPPORTED,
                           "DARTCollisionDetector has only spheres and boxes");
        }
        if (detector == Detector::fcl && kind == PL_SHAPE_CAPSULE) {
            return pl_fail(error, PL_UNSUPPORTED, "FCLCollisionDetector has no capsules");
        }
    }
    return PL_OK;
}

dynamics::ShapePtr pl_dart_make_shape(const pl_engine_setup &setup, const pl_shape &shape)
{
    const double *half = shape.half_extents;
    switch (shape.kind) {
    case PL_SHAPE_PLANE:
        if (has_planes(setup)) {
            return std::make_shared<dynamics::PlaneShape>(vector(shape.normal), shape.offset);
        }
        return std::make_shared<dynamics::BoxShape>(
            Eigen::Vector3d::Constant(2 * plane_reach(setup)));
    case PL_SHAPE_SPHERE:
        return std::make_shared<dynamics::SphereShape>(shape.radius);
    case PL_SHAPE_BOX:
        return std::make_shared<dynamics::BoxShape>(2 * vector(half));
    case PL_SHAPE_CAPSULE:
        return std::make_shared<dynamics::CapsuleShape>(shape.radius, 2 * shape.half_height);
    case PL_SHAPE_CYLINDER:
        return std::make_shared<dynamics::CylinderShape>(shape.radius, 2 * shape.half_height);
    case PL_SHAPE_HULL:
    case PL_SHAPE_MESH:
        break;
    }
    return make_mesh(*shape.polyhedron);
}

Eigen::Isometry3d pl_dart_pose(const pl_engine_setup &setup, const pl_body &body)
{
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    if (body.shape.kind != PL_SHAPE_PLANE) {
        pl_body_state at;
        pl_initial_state(&body, &at);
        pl_to_principal_pose(&body.shape, at.position, at.orientation);
        const double *q = at.orientation;
        pose.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
        pose.translation() = vector(at.position);
    } else if (!has_planes(setup)) {
        const Eigen::Vector3d normal = vector(body.shape.normal);
        const Eigen::Vector3d middle = (vector(setup.lower) + vector(setup.upper)) / 2;
        const double height = normal.dot(middle) - body.shape.offset;
        pose.linear() =
            Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal).toRotationMatrix();
        pose.translation() = middle - (height + plane_reach(setup)) * normal;
    }
    return pose;
}

collision::CollisionDetectorPtr pl_dart_make_detector(const pl_engine_setup &setup)
{
    switch (detector_of(setup)) {
    case Detector::fcl: {
        auto fcl = collision::FCLCollisionDetector::create();
        if (has_fcl_primitives(setup)) {
            fcl->setPrimitiveShapeType(collision::FCLCollisionDetector::PRIMITIVE);
        }
        return fcl;
    }
    case Detector::ode:
#ifdef PLUMB_HAVE_DART_ODE
        return collision::OdeCollisionDetector::create();
#else
        return nullptr;
#endif
    case Detector::own:
        return collision::DARTCollisionDetector::create();
    }
    return nullptr;
}
