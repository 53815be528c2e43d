/* DART's worlds. Read against the source of DART 6.12.1; dart_shapes.cpp has the shapes.
 *
 * Bodies: each is a skeleton of one body, on a FreeJoint, or on a WeldJoint and immobile when it is
 * static. A FreeJoint's velocities are in the axes of its body, angular ones first. The origin of a
 * body is its centre of mass, and its axes are the principal ones.
 *
 * Pairs: a ContactConstraint takes its coefficients from the shapes' DynamicsAspect when it is
 * made, within ConstraintSolver::updateConstraints, which cannot be overridden. So dart_pairs.h
 * says what the shapes must store.
 *
 * Signs: Contact::normal points from the second object to the first, and Contact::force acts on the
 * first.
 *
 * Two things differ from a world as shipped: pairs of static bodies are filtered, which would only
 * use up contacts, and the solver counts its groups. */
#include "dart_pairs.h"
#include "dart_shapes.h"

#include <dart/collision/CollisionFilter.hpp>
#include <dart/collision/CollisionObject.hpp>
#include <dart/constraint/BoxedLcpConstraintSolver.hpp>
#include <dart/constraint/ConstrainedGroup.hpp>
#include <dart/constraint/ContactConstraint.hpp>
#include <dart/constraint/DantzigBoxedLcpSolver.hpp>
#include <dart/constraint/PgsBoxedLcpSolver.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/external/odelcpsolver/misc.h>
#include <dart/math/Random.hpp>
#include <dart/simulation/World.hpp>
#include <dart_description.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

PL_ENGINE_FUNCTIONS(dart)

namespace collision = dart::collision;
namespace constraint = dart::constraint;
namespace dynamics = dart::dynamics;

namespace {

void store(const Eigen::Vector3d &v, double out[3])
{
    out[0] = v.x();
    out[1] = v.y();
    out[2] = v.z();
}

/* DART's solver, which counts its groups and declines one whose matrices would pass the limit. */
class CountingSolver final : public constraint::BoxedLcpConstraintSolver {
  public:
    using BoxedLcpConstraintSolver::BoxedLcpConstraintSolver;

    int groups = 0;
    double solve_time = 0; /* s */
    double refused_rows = 0, refused_bytes = 0;

    std::size_t contacts() const
    {
        return mContactConstraints.size();
    }

  protected:
    void solveConstrainedGroup(constraint::ConstrainedGroup &group) override
    {
        /* The matrix, its copy for the second solver, and Dantzig's factor. */
        constexpr double matrices = 3;
        const double rows = static_cast<double>(group.getTotalDimension());
        const double bytes = matrices * rows * rows * static_cast<double>(sizeof(double));
        if (bytes > pl_dense_limit) {
            refused_rows = rows;
            refused_bytes = bytes;
            return;
        }
        const double start = pl_seconds();
        BoxedLcpConstraintSolver::solveConstrainedGroup(group);
        solve_time += pl_seconds() - start;
        ++groups;
    }
};

/* The body that a shape belongs to, and the material that it is meant to meet. */
struct ShapeRole {
    int body, material, partner;
    bool is_static;
};

using ShapeRoles = std::unordered_map<const dynamics::ShapeFrame *, ShapeRole>;

/* DART's own filter, without pairs of static bodies and of shapes that are not meant to meet. */
class RoleFilter final : public collision::BodyNodeCollisionFilter {
  public:
    RoleFilter(const ShapeRoles &roles, bool by_partner) : roles_(roles), by_partner_(by_partner)
    {
    }

    bool ignoresCollision(const collision::CollisionObject *first,
                          const collision::CollisionObject *second) const override
    {
        const ShapeRole &a = roles_.at(first->getShapeFrame());
        const ShapeRole &b = roles_.at(second->getShapeFrame());
        if (a.is_static && b.is_static) {
            return true;
        }
        if (by_partner_ && (a.partner != b.material || b.partner != a.material)) {
            return true;
        }
        return BodyNodeCollisionFilter::ignoresCollision(first, second);
    }

  private:
    const ShapeRoles &roles_;
    bool by_partner_;
};

struct Pairs : pl_dart_pairs {
    Pairs() : pl_dart_pairs{}
    {
    }
    Pairs(const Pairs &) = delete;
    Pairs &operator=(const Pairs &) = delete;
    ~Pairs()
    {
        pl_dart_pairs_free(this);
    }
};

} // namespace

struct pl_engine_instance {
    const pl_engine_setup *setup;
    Pairs pairs;
    ShapeRoles roles;
    std::map<const pl_polyhedron *, dynamics::ShapePtr> solids; /* that bodies share */
    dart::simulation::WorldPtr world;
    CountingSolver *solver = nullptr;         /* the world's */
    std::vector<dynamics::BodyNode *> bodies; /* the world's skeletons' */
    double time = 0;
    long steps = 0;
};

namespace {

/* ---- Bodies ---- */

/* The shape of a body; one for all that share a hull or a mesh. */
dynamics::ShapePtr shape_of(pl_engine_instance &it, const pl_shape &shape)
{
    if (shape.polyhedron == nullptr) {
        return pl_dart_make_shape(*it.setup, shape);
    }
    dynamics::ShapePtr &known = it.solids[shape.polyhedron];
    if (known == nullptr) {
        known = pl_dart_make_shape(*it.setup, shape);
    }
    return known;
}

/* Puts the shape on a body, once for each material that it is meant to meet. */
void add_shapes(pl_engine_instance &it, dynamics::BodyNode &node, const pl_body &body, int index)
{
    const dynamics::ShapePtr shape = shape_of(it, body.shape);
    const int material = body.material;
    for (int partner = 0; partner < it.pairs.material_count; ++partner) {
        if (it.pairs.by_partner ? !pl_dart_can_touch(&it.pairs, material, partner) : partner > 0) {
            continue;
        }
        auto *made =
            node.createShapeNodeWith<dynamics::CollisionAspect, dynamics::DynamicsAspect>(shape);
        const pl_pair_coefficients stored = pl_dart_stored(&it.pairs, material, partner);
        made->getDynamicsAspect()->setFrictionCoeff(stored.friction);
        made->getDynamicsAspect()->setRestitutionCoeff(stored.restitution);
        it.roles[made] = ShapeRole{index, material, partner, body.is_static};
    }
}

void add_body(pl_engine_instance &it, const pl_body &body, int index)
{
    const auto skeleton = dynamics::Skeleton::create("body " + std::to_string(index));
    const Eigen::Isometry3d pose = pl_dart_pose(*it.setup, body);
    dynamics::BodyNode *node = nullptr;
    if (body.is_static) {
        const auto made = skeleton->createJointAndBodyNodePair<dynamics::WeldJoint>();
        made.first->setTransformFromParentBodyNode(pose);
        skeleton->setMobile(false);
        node = made.second;
    } else {
        const auto made = skeleton->createJointAndBodyNodePair<dynamics::FreeJoint>();
        node = made.second;
        node->setInertia(dynamics::Inertia(body.mass, Eigen::Vector3d::Zero(),
                                           vector(body.inertia).asDiagonal()));
        made.first->setTransform(pose);
        Eigen::Vector6d velocities;
        velocities << pose.linear().transpose() * vector(body.angular_velocity),
            pose.linear().transpose() * vector(body.velocity);
        made.first->setVelocities(velocities);
    }
    add_shapes(it, *node, body, index);
    it.world->addSkeleton(skeleton);
    it.bodies.push_back(node);
}

/* ---- The world ---- */

std::unique_ptr<CountingSolver> make_solver(const pl_engine_setup &setup)
{
    auto sweeps = std::make_shared<constraint::PgsBoxedLcpSolver>();
    constraint::PgsBoxedLcpSolver::Option option = sweeps->getOption();
    option.mMaxIteration = static_cast<int>(setup.values[OPTION_ITERATIONS]);
    option.mDeltaXThreshold = setup.values[OPTION_DELTA_X];
    option.mRelativeDeltaXTolerance = setup.values[OPTION_RELATIVE_DELTA_X];
    option.mRandomizeConstraintOrder = setup.values[OPTION_RANDOM_ORDER] > 0;
    sweeps->setOption(option);
    if (setup.profile == PROFILE_PGS) {
        return std::make_unique<CountingSolver>(sweeps, nullptr);
    }
    return std::make_unique<CountingSolver>(std::make_shared<constraint::DantzigBoxedLcpSolver>(),
                                            sweeps);
}

void set_contacts(const double *values)
{
    using Contacts = constraint::ContactConstraint;
    Contacts::setConstraintForceMixing(values[OPTION_CFM]);
    Contacts::setErrorReductionParameter(values[OPTION_ERP]);
    Contacts::setErrorAllowance(values[OPTION_ERROR_ALLOWANCE]);
    Contacts::setMaxErrorReductionVelocity(values[OPTION_MAX_ERV]);
}

pl_status fill(pl_engine_instance &it, pl_error *error)
{
    const pl_engine_setup &setup = *it.setup;
    const pl_scene &scene = *setup.scene;
    const pl_status status = pl_dart_check_shapes(setup, error);
    if (status != PL_OK) {
        return status;
    }
    if (pl_dart_pairs_of(&setup, &it.pairs) != PL_OK) {
        return pl_engine_error(error, PL_NO_MEMORY,
                               "out of memory for the materials of a DART world");
    }
    const collision::CollisionDetectorPtr detector = pl_dart_make_detector(setup);
    if (detector == nullptr) {
        return pl_engine_error(
            error, PL_UNSUPPORTED,
            "built without ODE's detector (Debian package libdart-collision-ode-dev)");
    }
    set_contacts(setup.values);
    /* PGS with random_order draws from this generator, which the process shares. */
    dart::external::ode::dRandSetSeed(0);
    dart::math::Random::setSeed(0);
    it.world = dart::simulation::World::create();
    it.world->setGravity(vector(scene.gravity));
    auto solver = make_solver(setup);
    it.solver = solver.get();
    it.world->setConstraintSolver(std::move(solver));
    it.solver->setCollisionDetector(detector);
    it.solver->getCollisionOption().maxNumContacts =
        static_cast<std::size_t>(setup.values[OPTION_MAX_CONTACTS]);
    it.solver->getCollisionOption().collisionFilter =
        std::make_shared<RoleFilter>(it.roles, it.pairs.by_partner);
    it.world->setTimeStep(setup.dt);
    for (int i = 0; i < scene.body_count; ++i) {
        add_body(it, scene.bodies[i], i);
    }
    return PL_OK;
}

/* ---- Contacts ---- */

/* Whether the solver was given the contact, by the rules of ConstraintSolver::updateConstraints. */
bool is_solved(const collision::Contact &contact)
{
    return !(contact.penetrationDepth < 0) && !collision::Contact::isZeroNormal(contact.normal);
}

void convert_contact(const pl_engine_instance &it, const collision::Contact &contact,
                     pl_contact &out)
{
    const int first = it.roles.at(contact.collisionObject1->getShapeFrame()).body;
    const int second = it.roles.at(contact.collisionObject2->getShapeFrame()).body;
    const Eigen::Vector3d impulse = contact.force * it.world->getTimeStep();
    pl_set_contact(&out, first, second, contact.point.data(), contact.normal.normalized().data(),
                   -contact.penetrationDepth, impulse.data());
}

/* The shape of a body that is meant to meet `partner`; null when there is none. */
const dynamics::DynamicsAspect *surface_of(const pl_engine_instance &it, int body, int partner)
{
    for (const dynamics::ShapeNode *node : it.bodies[static_cast<size_t>(body)]->getShapeNodes()) {
        if (!it.pairs.by_partner || it.roles.at(node).partner == partner) {
            return node->getDynamicsAspect();
        }
    }
    return nullptr;
}

/* ---- State ---- */

/* The state of a body in the frame of its shape. */
void read_body(const pl_engine_instance &it, int body, pl_body_state &state)
{
    const dynamics::BodyNode *node = it.bodies[static_cast<size_t>(body)];
    const Eigen::Isometry3d &pose = node->getWorldTransform();
    const Eigen::Quaterniond q(pose.linear());
    store(pose.translation(), state.position);
    store(node->getLinearVelocity(), state.velocity);
    store(node->getAngularVelocity(), state.angular_velocity);
    state.orientation[0] = q.w();
    state.orientation[1] = q.x();
    state.orientation[2] = q.y();
    state.orientation[3] = q.z();
    pl_to_shape_pose(&it.setup->scene->bodies[body].shape, state.position, state.orientation);
}

void add_forces(const pl_engine_instance &it, double dt)
{
    const pl_scene &scene = *it.setup->scene;
    for (int i = 0; i < scene.force_count; ++i) {
        const pl_force &force = scene.forces[i];
        pl_body_state state;
        double world_force[3], offset[3];
        if (scene.bodies[force.body].is_static) {
            continue;
        }
        read_body(it, force.body, state);
        if (pl_force_at(&force, it.time, dt, state.orientation, world_force, offset)) {
            dynamics::BodyNode *node = it.bodies[static_cast<size_t>(force.body)];
            node->addExtForce(vector(world_force));
            node->addExtTorque(vector(offset).cross(vector(world_force)));
        }
    }
}

} // namespace

/* DART's own values, also of a library that was built with others. They are asked once, before any world
 * changes the global ones. */
void pl_dart_defaults(int profile, double *values)
{
    static const std::array<double, OPTION_COUNT> shipped = [] {
        using Contacts = dart::constraint::ContactConstraint;
        const dart::constraint::PgsBoxedLcpSolver::Option sweeps;
        const dart::constraint::BoxedLcpConstraintSolver solver;
        std::array<double, OPTION_COUNT> found{};
        found[OPTION_ITERATIONS] = sweeps.mMaxIteration;
        found[OPTION_DELTA_X] = sweeps.mDeltaXThreshold;
        found[OPTION_RELATIVE_DELTA_X] = sweeps.mRelativeDeltaXTolerance;
        found[OPTION_RANDOM_ORDER] = sweeps.mRandomizeConstraintOrder;
        found[OPTION_MAX_CONTACTS] = static_cast<int>(solver.getCollisionOption().maxNumContacts);
        found[OPTION_CFM] = Contacts::getConstraintForceMixing();
        found[OPTION_ERP] = Contacts::getErrorReductionParameter();
        found[OPTION_ERROR_ALLOWANCE] = Contacts::getErrorAllowance();
        found[OPTION_MAX_ERV] = Contacts::getMaxErrorReductionVelocity();
        found[OPTION_FCL_PRIMITIVES] = 0; /* the constructor of ConstraintSolver sets MESH */
        return found;
    }();
    std::copy(shipped.begin(), shipped.end(), values);
    engine_profile_values(profile, values);
}

/* The settings of contacts are DART's global variables: the world that was made last has them. */
pl_status pl_dart_create(const pl_engine_setup *setup, pl_engine_instance **out, pl_error *error)
{
    double shipped[OPTION_COUNT];
    *out = nullptr;
    try {
        pl_dart_defaults(setup->profile, shipped);
        auto made = std::make_unique<pl_engine_instance>();
        made->setup = setup;
        const pl_status status = fill(*made, error);
        if (status == PL_OK) {
            *out = made.release();
        }
        return status;
    } catch (const std::bad_alloc &) {
        return pl_engine_error(error, PL_NO_MEMORY, "out of memory for a DART world");
    } catch (...) {
        return pl_engine_error(error, PL_FAILED, "DART threw an exception while making a world");
    }
}

void pl_dart_destroy(pl_engine_instance *instance)
{
    delete instance;
}

pl_status pl_dart_step(pl_engine_instance *instance, double dt, pl_step_stats *stats,
                       pl_error *error)
{
    CountingSolver &solver = *instance->solver;
    solver.groups = 0;
    solver.solve_time = 0;
    add_forces(*instance, dt);
    const double start = pl_seconds();
    try {
        instance->world->step();
    } catch (...) {
        return pl_fail(error, PL_FAILED, "DART threw an exception in step %ld",
                       instance->steps + 1);
    }
    const double elapsed = pl_seconds() - start;
    if (solver.refused_rows > 0) {
        return pl_refuse_dense(error, "dart", engine_profiles[instance->setup->profile].name,
                               solver.refused_rows, solver.refused_bytes);
    }
    stats->contacts = static_cast<double>(solver.contacts());
    stats->islands = solver.groups;
    stats->time_solve = solver.solve_time;
    stats->time_other = elapsed - solver.solve_time;
    instance->time += dt;
    ++instance->steps;
    return PL_OK;
}

void pl_dart_read_frame(const pl_engine_instance *instance, pl_frame *frame)
{
    const pl_scene &scene = *instance->setup->scene;
    frame->time = instance->time;
    for (int i = 0; i < frame->body_count; ++i) {
        if (scene.bodies[i].shape.kind == PL_SHAPE_PLANE) {
            /* Its shape has its place, or a box stands for it. */
            pl_initial_state(&scene.bodies[i], &frame->bodies[i]);
        } else {
            read_body(*instance, i, frame->bodies[i]);
        }
    }
}

void pl_dart_read_settings(const pl_engine_instance *instance, pl_engine_settings *settings)
{
    store(instance->world->getGravity(), settings->gravity);
    settings->dt = instance->world->getTimeStep();
    settings->linear_damping = 0;
    settings->angular_damping = 0;
    for (int i = 0; i < settings->body_count; ++i) {
        const dynamics::BodyNode *node = instance->bodies[static_cast<size_t>(i)];
        const dynamics::Joint *joint = node->getParentJoint();
        const bool moves = node->getSkeleton()->isMobile();
        settings->mass[i] = moves ? node->getMass() : 0;
        for (int k = 0; k < 3; ++k) {
            settings->inertia[i][k] = moves ? node->getInertia().getMoment()(k, k) : 0;
        }
        for (std::size_t k = 0; k < joint->getNumDofs(); ++k) {
            double &damping = k < 3 ? settings->angular_damping : settings->linear_damping;
            damping = std::fmax(damping, joint->getDampingCoefficient(k));
        }
    }
}

/* DART's rule of mixing on what its shapes store; NAN where no shapes of the two bodies are meant to
 * touch. */
void pl_dart_read_pair(const pl_engine_instance *instance, int body_a, int body_b,
                       pl_pair_coefficients *found)
{
    const pl_body *bodies = instance->setup->scene->bodies;
    const auto *a = surface_of(*instance, body_a, bodies[body_b].material);
    const auto *b = surface_of(*instance, body_b, bodies[body_a].material);
    found->friction = NAN;
    found->restitution = NAN;
    if (a != nullptr && b != nullptr) {
        found->friction = std::fmin(a->getPrimaryFrictionCoeff(), b->getPrimaryFrictionCoeff());
        found->restitution = a->getRestitutionCoeff() * b->getRestitutionCoeff();
    }
}

int pl_dart_read_contacts(const pl_engine_instance *instance, pl_contact *contacts, int capacity)
{
    const auto &found = instance->world->getLastCollisionResult();
    int count = 0;
    for (std::size_t i = 0; i < found.getNumContacts(); ++i) {
        if (is_solved(found.getContact(i))) {
            if (count < capacity) {
                convert_contact(*instance, found.getContact(i), contacts[count]);
            }
            ++count;
        }
    }
    return count;
}
