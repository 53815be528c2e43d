/* Bullet's worlds, in the only file that includes Bullet's headers. No C++ exception passes through it.
 * Read against the source of Bullet 3.24.
 *
 * Iterations and residual: btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyIterations
 * leaves both in m_analyticsData, a group of islands at a time; a derived solver reads them after
 * each group. A row's residual there is its last change of impulse divided by the row's effective
 * mass, a velocity; m_remainingLeastSquaresResidual is the largest square of it over the rows
 * (sequential impulse) or the sum of the squares (NNCG), in m^2/s^2. The dense solvers report
 * neither.
 *
 * Friction and restitution of a pair come through Bullet's two global callbacks, which find the
 * world through the bodies themselves.
 *
 * Signs: m_normalWorldOnB points from Bullet's B to its A, and m_appliedImpulse acts along it on A.
 *
 * Margins: btBoxShape and btCylinderShape keep theirs inside the half extents that they are given
 * (their implicit half extents are smaller by it), so that their faces and the cylinder's side are
 * where they should be. Two boxes, and a box on a plane, have their true edges too; elsewhere edges
 * are rounded by the margin, and a cylinder on its rim sinks by up to (sqrt 2 - 1) of it. A capsule
 * has no margin but its radius. btConvexHullShape and btGImpactMeshShape put theirs (0.04 m and
 * 0.01 m by default) around the shape, which would rest that much too high: here they get
 * `solid_margin`, by default 0, so that they have their true size. Measured on 3.24: with margin 0
 * a tower of three hulls stands, its top 0.3 mm low after 10 s, like one of boxes; the deepest
 * contact of a hull or a mesh with a sphere or a capsule is that of the true shapes; of two hulls 1
 * cm deep in each other, 2 of 60 poses got a normal more than 10 degrees off, with 1 mm of margin
 * none.
 *
 * Meshes: a moving one is a btGImpactMeshShape with the dispatcher's algorithm of its own, which
 * knows planes (every vertex below), convex shapes and other meshes; a static one is a
 * btBvhTriangleMeshShape, whose inner edges are felt. Two meshes touch triangle by triangle, which
 * has no depth for faces that lie in each other: of cubes of triangles dropped askew on a slab of
 * triangles none fell through in 20 poses (the worst ended 9 mm deep), but one that starts flush
 * with the edges of another falls through it.
 *
 * Rolling and spinning friction are 0, Bullet's default. */
#include "bullet_c.h"

#include "adapters/native.h"

#include <bullet_description.h>

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <BulletDynamics/ConstraintSolver/btNNCGConstraintSolver.h>
#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btLemkeSolver.h>
#include <BulletDynamics/MLCPSolvers/btMLCPSolver.h>
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#ifndef BT_USE_DOUBLE_PRECISION
#error "Bullet must be used in double precision: pkg-config bullet-float64"
#endif
static_assert(sizeof(btScalar) == sizeof(double), "Bullet must be used in double precision");

namespace {

btVector3 vector(const double v[3])
{
    return btVector3(v[0], v[1], v[2]);
}

void store(const btVector3 &v, double out[3])
{
    out[0] = v.x();
    out[1] = v.y();
    out[2] = v.z();
}

/* What the solver has to say of one step, over all its groups. */
struct StepReport {
    double iterations = NAN, residual = NAN;
    double refused_rows = 0, refused_bytes = 0;
};

/* A solver that keeps its analytics, as the iterative ones fill them. */
template <class Base> class ReportingSolver final : public Base {
  public:
    explicit ReportingSolver(StepReport &report) : report_(report)
    {
    }

    btScalar solveGroup(btCollisionObject **bodies, int body_count,
                        btPersistentManifold **manifolds, int manifold_count,
                        btTypedConstraint **joints, int joint_count,
                        const btContactSolverInfo &info, btIDebugDraw *drawer,
                        btDispatcher *dispatcher) override
    {
        this->m_analyticsData = btSolverAnalyticsData();
        btScalar result = Base::solveGroup(bodies, body_count, manifolds, manifold_count, joints,
                                           joint_count, info, drawer, dispatcher);
        if (this->m_analyticsData.m_numIterationsUsed >= 0) {
            report_.iterations =
                std::fmax(report_.iterations, this->m_analyticsData.m_numIterationsUsed);
            report_.residual =
                std::fmax(report_.residual, this->m_analyticsData.m_remainingLeastSquaresResidual);
        }
        return result;
    }

  private:
    StepReport &report_;
};

/* A dense solver that declines a group whose matrices would pass the limit. */
class DenseSolver final : public btMLCPSolver {
  public:
    /* `matrices` is how many times rows^2 numbers are held at once. */
    DenseSolver(std::unique_ptr<btMLCPSolverInterface> method, double matrices, StepReport &report)
        : btMLCPSolver(method.get()), method_(std::move(method)), matrices_(matrices),
          report_(report)
    {
    }

    btScalar solveGroup(btCollisionObject **bodies, int body_count,
                        btPersistentManifold **manifolds, int manifold_count,
                        btTypedConstraint **joints, int joint_count,
                        const btContactSolverInfo &info, btIDebugDraw *drawer,
                        btDispatcher *dispatcher) override
    {
        /* By default Bullet has one friction row a contact point. */
        int rows_a_point = (info.m_solverMode & SOLVER_USE_2_FRICTION_DIRECTIONS) != 0 ? 3 : 2;
        double rows = 0;
        for (int i = 0; i < manifold_count; ++i) {
            rows += rows_a_point * manifolds[i]->getNumContacts();
        }
        double bytes = matrices_ * rows * rows * sizeof(btScalar);
        if (bytes > pl_dense_limit) {
            report_.refused_rows = rows;
            report_.refused_bytes = bytes;
            return 0;
        }
        return btMLCPSolver::solveGroup(bodies, body_count, manifolds, manifold_count, joints,
                                        joint_count, info, drawer, dispatcher);
    }

  private:
    std::unique_ptr<btMLCPSolverInterface> method_;
    double matrices_;
    StepReport &report_;
};

/* Bullet's world with a stopwatch on its two large parts. */
class TimedWorld final : public btDiscreteDynamicsWorld {
  public:
    using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;

    double collide = 0, solve = 0; /* s, of the last step */

    void performDiscreteCollisionDetection() override
    {
        double start = pl_seconds();
        btDiscreteDynamicsWorld::performDiscreteCollisionDetection();
        collide = pl_seconds() - start;
    }

  protected:
    void solveConstraints(btContactSolverInfo &info) override
    {
        double start = pl_seconds();
        btDiscreteDynamicsWorld::solveConstraints(info);
        solve = pl_seconds() - start;
    }
};

/* A and its copies: m_A, Acopy, the method's own; and what btLemkeSolver and btLemkeAlgorithm add:
 * A1, B, n x 2n to invert, M and its two copies of 2n x 2n, and a tableau of 2n x 4n. */
constexpr double dantzig_matrices = 4, lemke_matrices = 2 + 4 + 3 * 4 + 8;

/* The triangles of a mesh, which its shape borrows. */
struct Triangles {
    std::vector<double> vertices; /* (vertex_count x 3), in the principal frame */
    btTriangleIndexVertexArray array;
};

} // namespace

struct pl_engine_instance {
    const pl_engine_setup *setup;
    double time = 0; /* s */
    long steps = 0;
    StepReport report;

    /* Destroyed from the last to the first: bodies leave the world before it goes. */
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    std::unique_ptr<btSequentialImpulseConstraintSolver> solver;
    std::unique_ptr<TimedWorld> world;
    std::vector<std::unique_ptr<Triangles>> triangles;
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    /* Shapes that bodies share: of a hull or mesh, moving or static. */
    std::map<std::pair<const pl_polyhedron *, bool>, btCollisionShape *> solids;
    std::vector<std::unique_ptr<btRigidBody>> bodies;

    ~pl_engine_instance()
    {
        for (auto &body : bodies) {
            world->removeRigidBody(body.get());
        }
    }
};

namespace {

/* The coefficients of a contact of two bodies. */
pl_pair_coefficients pair_of(const btCollisionObject *a, const btCollisionObject *b)
{
    auto *instance = static_cast<const pl_engine_instance *>(a->getUserPointer());
    return pl_setup_pair(instance->setup, a->getUserIndex(), b->getUserIndex());
}

btScalar combined_friction(const btCollisionObject *a, const btCollisionObject *b)
{
    return pair_of(a, b).friction;
}

btScalar combined_restitution(const btCollisionObject *a, const btCollisionObject *b)
{
    return pair_of(a, b).restitution;
}

std::unique_ptr<btSequentialImpulseConstraintSolver> make_solver(int profile, StepReport &report)
{
    switch (profile) {
    case PROFILE_NNCG:
        return std::make_unique<ReportingSolver<btNNCGConstraintSolver>>(report);
    case PROFILE_DANTZIG:
        return std::make_unique<DenseSolver>(std::make_unique<btDantzigSolver>(), dantzig_matrices,
                                             report);
    case PROFILE_LEMKE:
        return std::make_unique<DenseSolver>(std::make_unique<btLemkeSolver>(), lemke_matrices,
                                             report);
    default:
        return std::make_unique<ReportingSolver<btSequentialImpulseConstraintSolver>>(report);
    }
}

std::vector<double> vertices_of(const pl_polyhedron &solid)
{
    std::vector<double> vertices(3 * static_cast<size_t>(solid.vertex_count));
    for (int i = 0; i < solid.vertex_count; ++i) {
        pl_vertex_in_principal(&solid, i, &vertices[3 * static_cast<size_t>(i)]);
    }
    return vertices;
}

std::unique_ptr<btCollisionShape> make_hull(const pl_polyhedron &solid, double margin)
{
    auto hull = std::make_unique<btConvexHullShape>();
    std::vector<double> vertices = vertices_of(solid);
    for (size_t i = 0; i < vertices.size(); i += 3) {
        hull->addPoint(vector(&vertices[i]), false);
    }
    hull->setMargin(margin);
    hull->recalcLocalAabb();
    return hull;
}

std::unique_ptr<btCollisionShape> make_mesh(pl_engine_instance &world, const pl_polyhedron &solid,
                                            bool is_static)
{
    auto triangles = std::make_unique<Triangles>();
    triangles->vertices = vertices_of(solid);
    btIndexedMesh mesh;
    mesh.m_numTriangles = solid.triangle_count;
    mesh.m_triangleIndexBase = reinterpret_cast<const unsigned char *>(solid.triangles);
    mesh.m_triangleIndexStride = sizeof *solid.triangles;
    mesh.m_numVertices = solid.vertex_count;
    mesh.m_vertexBase = reinterpret_cast<const unsigned char *>(triangles->vertices.data());
    mesh.m_vertexStride = 3 * sizeof(double);
    triangles->array.addIndexedMesh(mesh);
    world.triangles.push_back(std::move(triangles));
    btTriangleIndexVertexArray *array = &world.triangles.back()->array;
    if (is_static) {
        return std::make_unique<btBvhTriangleMeshShape>(array, true);
    }
    auto moving = std::make_unique<btGImpactMeshShape>(array);
    moving->setMargin(world.setup->values[OPTION_SOLID_MARGIN]);
    moving->updateBound();
    return moving;
}

/* Null for a shape that Bullet has not. */
std::unique_ptr<btCollisionShape> make_shape(pl_engine_instance &world, const pl_shape &shape,
                                             bool is_static)
{
    double margin = world.setup->values[OPTION_MARGIN];
    switch (shape.kind) {
    case PL_SHAPE_PLANE:
        return std::make_unique<btStaticPlaneShape>(vector(shape.normal), shape.offset);
    case PL_SHAPE_SPHERE:
        return std::make_unique<btSphereShape>(shape.radius);
    case PL_SHAPE_BOX: {
        auto box = std::make_unique<btBoxShape>(vector(shape.half_extents));
        box->setMargin(margin);
        /* Bullet's own rule for small boxes: at most a tenth of the least half extent. */
        box->setSafeMargin(vector(shape.half_extents));
        return box;
    }
    case PL_SHAPE_CAPSULE:
        return std::make_unique<btCapsuleShapeZ>(shape.radius, 2 * shape.half_height);
    case PL_SHAPE_CYLINDER: {
        btVector3 half_extents(shape.radius, shape.radius, shape.half_height);
        auto cylinder = std::make_unique<btCylinderShapeZ>(half_extents);
        cylinder->setMargin(margin);
        cylinder->setSafeMargin(half_extents);
        return cylinder;
    }
    case PL_SHAPE_HULL:
        return make_hull(*shape.polyhedron, world.setup->values[OPTION_SOLID_MARGIN]);
    case PL_SHAPE_MESH:
        return make_mesh(world, *shape.polyhedron, is_static);
    }
    return nullptr;
}

/* The shape of a body, owned by the world: one for all that share a hull or a mesh. */
btCollisionShape *shape_of(pl_engine_instance &world, const pl_body &body)
{
    std::pair<const pl_polyhedron *, bool> key(body.shape.polyhedron, body.is_static);
    auto known = world.solids.find(key);
    if (key.first != nullptr && known != world.solids.end()) {
        return known->second;
    }
    auto shape = make_shape(world, body.shape, body.is_static);
    if (shape == nullptr) {
        return nullptr;
    }
    world.shapes.push_back(std::move(shape));
    btCollisionShape *made = world.shapes.back().get();
    if (key.first != nullptr) {
        world.solids[key] = made;
    }
    return made;
}

bool add_body(pl_engine_instance &world, const pl_body &body)
{
    btCollisionShape *shape = shape_of(world, body);
    if (shape == nullptr) {
        return false;
    }
    pl_body_state at;
    pl_initial_state(&body, &at);
    pl_to_principal_pose(&body.shape, at.position, at.orientation);
    const double *q = at.orientation;
    btTransform pose = btTransform::getIdentity();
    if (body.shape.kind != PL_SHAPE_PLANE) {
        pose = btTransform(btQuaternion(q[1], q[2], q[3], q[0]), vector(at.position));
    }
    double mass = body.is_static ? 0 : body.mass;
    btVector3 inertia = body.is_static ? btVector3(0, 0, 0) : vector(body.inertia);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, inertia);
    info.m_startWorldTransform = pose;
    auto made = std::make_unique<btRigidBody>(info);
    made->setUserPointer(&world);
    made->setUserIndex(static_cast<int>(world.bodies.size()));
    if (!body.is_static) {
        made->setLinearVelocity(vector(body.velocity));
        made->setAngularVelocity(vector(body.angular_velocity));
        made->forceActivationState(DISABLE_DEACTIVATION);
    }
    world.world->addRigidBody(made.get());
    world.bodies.push_back(std::move(made));
    return true;
}

void convert_contact(const btPersistentManifold &manifold, const btManifoldPoint &point,
                     pl_contact &out)
{
    int a = manifold.getBody0()->getUserIndex(), b = manifold.getBody1()->getUserIndex();
    btVector3 on_first = point.m_normalWorldOnB * point.m_appliedImpulse +
                         point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1;
    if (point.m_appliedImpulseLateral2 != 0) { /* of two friction directions; else not set */
        on_first += point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2;
    }
    pl_set_contact(&out, a, b, a < b ? point.getPositionWorldOnB() : point.getPositionWorldOnA(),
                   point.m_normalWorldOnB, point.getDistance(), on_first);
}

void set_solver_info(const double *values, btContactSolverInfo &info)
{
    info.m_numIterations = static_cast<int>(values[OPTION_ITERATIONS]);
    info.m_splitImpulse = values[OPTION_SPLIT_IMPULSE] > 0;
    info.m_splitImpulsePenetrationThreshold = values[OPTION_SPLIT_THRESHOLD];
    info.m_erp = values[OPTION_ERP];
    info.m_erp2 = values[OPTION_ERP2];
    info.m_restitutionVelocityThreshold = values[OPTION_RESTITUTION_THRESHOLD];
    info.m_warmstartingFactor = values[OPTION_WARM_START];
    info.m_linearSlop = values[OPTION_SLOP];
    info.m_solverMode &= ~(SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_RANDMIZE_ORDER);
    info.m_solverMode |=
        values[OPTION_FRICTION_DIRECTIONS] == 2 ? SOLVER_USE_2_FRICTION_DIRECTIONS : 0;
    info.m_solverMode |= values[OPTION_RANDOM_ORDER] > 0 ? SOLVER_RANDMIZE_ORDER : 0;
}

/* A world without bodies. */
std::unique_ptr<pl_engine_instance> make_world(const pl_engine_setup &setup)
{
    const double *values = setup.values;
    auto made = std::make_unique<pl_engine_instance>();
    const int plane_points = static_cast<int>(values[OPTION_PLANE_MULTIPOINT]);
    const int convex_points = static_cast<int>(values[OPTION_CONVEX_MULTIPOINT]);
    made->setup = &setup;
    if (plane_points > 0) {
        made->configuration.setPlaneConvexMultipointIterations(plane_points, plane_points);
    }
    if (convex_points > 0) {
        made->configuration.setConvexConvexMultipointIterations(convex_points, convex_points);
    }
    made->solver = make_solver(setup.profile, made->report);
    made->world = std::make_unique<TimedWorld>(&made->dispatcher, &made->broadphase,
                                               made->solver.get(), &made->configuration);
    made->world->setGravity(vector(setup.scene->gravity));
    set_solver_info(values, made->world->getSolverInfo());
    gContactBreakingThreshold = values[OPTION_CONTACT_BREAKING];
    btGImpactCollisionAlgorithm::registerAlgorithm(&made->dispatcher);
    gCalculateCombinedFrictionCallback = combined_friction;
    gCalculateCombinedRestitutionCallback = combined_restitution;
    return made;
}

/* The state of a body in the frame of its shape. */
void read_body(const pl_engine_instance &instance, int body, pl_body_state &state)
{
    const btRigidBody &source = *instance.bodies[static_cast<size_t>(body)];
    btQuaternion q = source.getOrientation();
    store(source.getCenterOfMassPosition(), state.position);
    store(source.getLinearVelocity(), state.velocity);
    store(source.getAngularVelocity(), state.angular_velocity);
    state.orientation[0] = q.w();
    state.orientation[1] = q.x();
    state.orientation[2] = q.y();
    state.orientation[3] = q.z();
    pl_to_shape_pose(&instance.setup->scene->bodies[body].shape, state.position, state.orientation);
}

void add_forces(pl_engine_instance &instance, double dt)
{
    const pl_scene &scene = *instance.setup->scene;
    for (int i = 0; i < scene.force_count; ++i) {
        const pl_force &force = scene.forces[i];
        pl_body_state state;
        double world_force[3], offset[3];
        read_body(instance, force.body, state);
        if (!scene.bodies[force.body].is_static &&
            pl_force_at(&force, instance.time, dt, state.orientation, world_force, offset)) {
            instance.bodies[static_cast<size_t>(force.body)]->applyForce(vector(world_force),
                                                                         vector(offset));
        }
    }
}

} // namespace

/* The settings that Bullet's own constructors make, also those of a library that was built with others; for
 * `recommended`, those of its sources. */
void pl_bullet_defaults(int profile, double *values)
{
    btContactSolverInfo info;
    btBoxShape box(btVector3(1, 1, 1));
    values[OPTION_ITERATIONS] = info.m_numIterations;
    values[OPTION_SPLIT_IMPULSE] = info.m_splitImpulse != 0;
    values[OPTION_SPLIT_THRESHOLD] = info.m_splitImpulsePenetrationThreshold;
    values[OPTION_ERP] = info.m_erp;
    values[OPTION_ERP2] = info.m_erp2;
    values[OPTION_RESTITUTION_THRESHOLD] = info.m_restitutionVelocityThreshold;
    values[OPTION_MARGIN] = box.getMargin();
    values[OPTION_FRICTION_DIRECTIONS] =
        (info.m_solverMode & SOLVER_USE_2_FRICTION_DIRECTIONS) != 0 ? 2 : 1;
    values[OPTION_WARM_START] = info.m_warmstartingFactor;
    values[OPTION_RANDOM_ORDER] = (info.m_solverMode & SOLVER_RANDMIZE_ORDER) != 0;
    values[OPTION_SLOP] = info.m_linearSlop;
    values[OPTION_CONTACT_BREAKING] = gContactBreakingThreshold;
    engine_profile_values(profile, values);
}

pl_status pl_bullet_create(const pl_engine_setup *setup, pl_engine_instance **out, pl_error *error)
{
    const pl_body *body = nullptr;
    pl_status status = PL_NO_MEMORY;
    *out = nullptr;
    try {
        auto made = make_world(*setup);
        bool is_known = true;
        for (int i = 0; i < setup->scene->body_count && is_known; ++i) {
            body = &setup->scene->bodies[i];
            is_known = add_body(*made, *body);
        }
        if (is_known) {
            *out = made.release();
            return PL_OK;
        }
        status = PL_UNSUPPORTED;
    } catch (...) {
        if (body == nullptr) {
            return pl_fail(error, PL_NO_MEMORY, "bullet could not make a world");
        }
    }
    return pl_fail(error, status, "body \"%s\": bullet could not make its shape (kind %d)",
                   body->name, static_cast<int>(body->shape.kind));
}

/* Says how often a dense solver left islands to sequential impulse. */
void pl_bullet_destroy(pl_engine_instance *instance)
{
    const auto *dense =
        instance == nullptr ? nullptr : dynamic_cast<const DenseSolver *>(instance->solver.get());
    if (dense != nullptr && dense->getNumFallbacks() > 0) {
        fprintf(stderr,
                "bullet:%s gave up %d times in %ld steps and fell back to sequential impulse\n",
                engine_profiles[instance->setup->profile].name, dense->getNumFallbacks(),
                instance->steps);
    }
    delete instance;
}

pl_status pl_bullet_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                         pl_error *error)
{
    TimedWorld &world = *instance->world;
    add_forces(*instance, dt);
    instance->report = StepReport();
    const double start = pl_seconds();
    try {
        /* No substeps: the step is dt itself. */
        world.stepSimulation(dt, 0);
    } catch (...) {
        return pl_fail(error, PL_FAILED, "bullet threw an exception in step %ld",
                       instance->steps + 1);
    }
    const double elapsed = pl_seconds() - start;
    if (instance->report.refused_rows > 0) {
        return pl_refuse_dense(error, "bullet", engine_profiles[instance->setup->profile].name,
                               instance->report.refused_rows, instance->report.refused_bytes);
    }
    stats->iterations = instance->report.iterations;
    stats->residual = instance->report.residual;
    stats->contacts = pl_bullet_read_contacts(instance, nullptr, 0);
    stats->time_collide = world.collide;
    stats->time_solve = world.solve;
    stats->time_other = elapsed - world.collide - world.solve;
    instance->time += dt;
    ++instance->steps;
    return PL_OK;
}

void pl_bullet_read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    frame->time = instance->time;
    for (int i = 0; i < frame->body_count; ++i) {
        const pl_body &body = instance->setup->scene->bodies[i];
        if (body.shape.kind == PL_SHAPE_PLANE) {
            /* The shape of a plane has its position, and its body stays at the origin. */
            pl_initial_state(&body, &frame->bodies[i]);
        } else {
            read_body(*instance, i, frame->bodies[i]);
        }
    }
}

void pl_bullet_read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    store(instance->world->getGravity(), settings->gravity);
    for (int i = 0; i < settings->body_count; ++i) {
        const btRigidBody &source = *instance->bodies[static_cast<size_t>(i)];
        const btVector3 &inverse = source.getInvInertiaDiagLocal();
        settings->mass[i] = source.getInvMass() > 0 ? 1 / source.getInvMass() : 0;
        for (int k = 0; k < 3; ++k) {
            settings->inertia[i][k] = inverse[k] > 0 ? 1 / inverse[k] : 0;
        }
    }
}

void pl_bullet_read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                         pl_pair_coefficients *found)
{
    const btRigidBody *a = instance->bodies[static_cast<size_t>(body_a)].get();
    const btRigidBody *b = instance->bodies[static_cast<size_t>(body_b)].get();
    found->friction = gCalculateCombinedFrictionCallback(a, b);
    found->restitution = gCalculateCombinedRestitutionCallback(a, b);
}

int pl_bullet_read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    auto &dispatcher = const_cast<btCollisionDispatcher &>(instance->dispatcher);
    int count = 0;
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
        const btPersistentManifold &manifold = *dispatcher.getManifoldByIndexInternal(i);
        for (int j = 0; j < manifold.getNumContacts(); ++j, ++count) {
            if (count < capacity) {
                convert_contact(manifold, manifold.getContactPoint(j), contacts[count]);
            }
        }
    }
    return count;
}
