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
#include "dart_c.h"

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

#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace collision = dart::collision;
namespace constraint = dart::constraint;
namespace dynamics = dart::dynamics;

namespace {

double now()
{
    using clock = std::chrono::steady_clock;
    return std::chrono::duration<double>(clock::now().time_since_epoch()).count();
}

Eigen::Vector3d vector(const double v[3])
{
    return Eigen::Vector3d(v[0], v[1], v[2]);
}

void store(const Eigen::Vector3d &v, double out[3])
{
    out[0] = v.x();
    out[1] = v.y();
    out[2] = v.z();
}

/* DART's solver, which counts its groups and declines one whose matrices would pass the limit. */
class CountingSolver final : public constraint::BoxedLcpConstraintSolver {
  public:
    CountingSolver(constraint::BoxedLcpSolverPtr first, constraint::BoxedLcpSolverPtr second,
                   double limit)
        : BoxedLcpConstraintSolver(std::move(first), std::move(second)), limit_(limit)
    {
    }

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
        if (bytes > limit_) {
            refused_rows = rows;
            refused_bytes = bytes;
            return;
        }
        const double start = now();
        BoxedLcpConstraintSolver::solveConstrainedGroup(group);
        solve_time += now() - start;
        ++groups;
    }

  private:
    double limit_;
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

struct pl_dart_world {
    const pl_engine_setup *setup;
    pl_dart_world_def def;
    Pairs pairs;
    ShapeRoles roles;
    std::map<const pl_polyhedron *, dynamics::ShapePtr> solids; /* that bodies share */
    dart::simulation::WorldPtr world;
    CountingSolver *solver = nullptr;         /* the world's */
    std::vector<dynamics::BodyNode *> bodies; /* the world's skeletons' */
};

namespace {

/* ---- Bodies ---- */

/* The shape of a body; one for all that share a hull or a mesh. */
dynamics::ShapePtr shape_of(pl_dart_world &world, const pl_shape &shape)
{
    if (shape.polyhedron == nullptr) {
        return pl_dart_make_shape(world.def, *world.setup, shape);
    }
    dynamics::ShapePtr &known = world.solids[shape.polyhedron];
    if (known == nullptr) {
        known = pl_dart_make_shape(world.def, *world.setup, shape);
    }
    return known;
}

/* Puts the shape on a body, once for each material that it is meant to meet. */
void add_shapes(pl_dart_world &world, dynamics::BodyNode &node, const pl_body &body, int index)
{
    const dynamics::ShapePtr shape = shape_of(world, body.shape);
    const int material = body.material;
    for (int partner = 0; partner < world.pairs.material_count; ++partner) {
        if (world.pairs.by_partner ? !pl_dart_can_touch(&world.pairs, material, partner)
                                   : partner > 0) {
            continue;
        }
        auto *made =
            node.createShapeNodeWith<dynamics::CollisionAspect, dynamics::DynamicsAspect>(shape);
        const pl_pair_coefficients stored = pl_dart_stored(&world.pairs, material, partner);
        made->getDynamicsAspect()->setFrictionCoeff(stored.friction);
        made->getDynamicsAspect()->setRestitutionCoeff(stored.restitution);
        world.roles[made] = ShapeRole{index, material, partner, body.is_static};
    }
}

void add_body(pl_dart_world &world, const pl_body &body, int index)
{
    const auto skeleton = dynamics::Skeleton::create("body " + std::to_string(index));
    const Eigen::Isometry3d pose = pl_dart_pose(world.def, *world.setup, body);
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
    add_shapes(world, *node, body, index);
    world.world->addSkeleton(skeleton);
    world.bodies.push_back(node);
}

/* ---- The world ---- */

std::unique_ptr<CountingSolver> make_solver(const pl_dart_world_def &def)
{
    const pl_dart_settings &settings = def.settings;
    auto sweeps = std::make_shared<constraint::PgsBoxedLcpSolver>();
    constraint::PgsBoxedLcpSolver::Option option = sweeps->getOption();
    option.mMaxIteration = settings.iterations;
    option.mDeltaXThreshold = settings.delta_x;
    option.mRelativeDeltaXTolerance = settings.relative_delta_x;
    option.mRandomizeConstraintOrder = settings.random_order;
    sweeps->setOption(option);
    if (def.pgs) {
        return std::make_unique<CountingSolver>(sweeps, nullptr, def.matrix_limit);
    }
    return std::make_unique<CountingSolver>(std::make_shared<constraint::DantzigBoxedLcpSolver>(),
                                            sweeps, def.matrix_limit);
}

void set_contacts(const pl_dart_settings &settings)
{
    using Contacts = constraint::ContactConstraint;
    Contacts::setConstraintForceMixing(settings.cfm);
    Contacts::setErrorReductionParameter(settings.erp);
    Contacts::setErrorAllowance(settings.error_allowance);
    Contacts::setMaxErrorReductionVelocity(settings.max_erv);
}

pl_status fill(pl_dart_world &world, pl_error *error)
{
    const pl_engine_setup &setup = *world.setup;
    const pl_scene &scene = *setup.scene;
    for (int i = 0; i < scene.body_count; ++i) {
        const char *reason = pl_dart_why_not(world.def, scene.bodies[i].shape.kind);
        if (reason != nullptr) {
            return pl_engine_error(error, PL_UNSUPPORTED, reason);
        }
    }
    if (pl_dart_pairs_of(&setup, &world.pairs) != PL_OK) {
        return pl_engine_error(error, PL_NO_MEMORY,
                               "out of memory for the materials of a DART world");
    }
    const collision::CollisionDetectorPtr detector = pl_dart_make_detector(world.def);
    if (detector == nullptr) {
        return pl_engine_error(
            error, PL_UNSUPPORTED,
            "built without ODE's detector (Debian package libdart-collision-ode-dev)");
    }
    set_contacts(world.def.settings);
    /* PGS with random_order draws from this generator, which the process shares. */
    dart::external::ode::dRandSetSeed(0);
    dart::math::Random::setSeed(0);
    world.world = dart::simulation::World::create();
    world.world->setGravity(vector(scene.gravity));
    auto solver = make_solver(world.def);
    world.solver = solver.get();
    world.world->setConstraintSolver(std::move(solver));
    world.solver->setCollisionDetector(detector);
    world.solver->getCollisionOption().maxNumContacts =
        static_cast<std::size_t>(world.def.settings.max_contacts);
    world.solver->getCollisionOption().collisionFilter =
        std::make_shared<RoleFilter>(world.roles, world.pairs.by_partner);
    world.world->setTimeStep(setup.dt);
    for (int i = 0; i < scene.body_count; ++i) {
        add_body(world, scene.bodies[i], i);
    }
    return PL_OK;
}

/* ---- Contacts ---- */

/* Whether the solver was given the contact, by the rules of ConstraintSolver::updateConstraints. */
bool is_solved(const collision::Contact &contact)
{
    return !(contact.penetrationDepth < 0) && !collision::Contact::isZeroNormal(contact.normal);
}

void convert_contact(const pl_dart_world &world, const collision::Contact &contact, pl_contact &out)
{
    const int first = world.roles.at(contact.collisionObject1->getShapeFrame()).body;
    const int second = world.roles.at(contact.collisionObject2->getShapeFrame()).body;
    const bool in_order = first < second;
    const double sign = in_order ? -1 : 1;
    out.body_a = in_order ? first : second;
    out.body_b = in_order ? second : first;
    out.separation = -contact.penetrationDepth;
    store(contact.point, out.point);
    store(sign * contact.normal.normalized(), out.normal);
    store(sign * contact.force * world.world->getTimeStep(), out.impulse);
}

/* The shape of a body that is meant to meet `partner`; null when there is none. */
const dynamics::DynamicsAspect *surface_of(const pl_dart_world &world, int body, int partner)
{
    for (const dynamics::ShapeNode *node :
         world.bodies[static_cast<size_t>(body)]->getShapeNodes()) {
        if (!world.pairs.by_partner || world.roles.at(node).partner == partner) {
            return node->getDynamicsAspect();
        }
    }
    return nullptr;
}

} // namespace

pl_dart_settings pl_dart_defaults(void)
{
    /* Asked before any world changes the global ones. */
    static const pl_dart_settings defaults = [] {
        using Contacts = constraint::ContactConstraint;
        const constraint::PgsBoxedLcpSolver::Option sweeps;
        const constraint::BoxedLcpConstraintSolver solver;
        pl_dart_settings found;
        found.iterations = sweeps.mMaxIteration;
        found.delta_x = sweeps.mDeltaXThreshold;
        found.relative_delta_x = sweeps.mRelativeDeltaXTolerance;
        found.random_order = sweeps.mRandomizeConstraintOrder;
        found.max_contacts = static_cast<int>(solver.getCollisionOption().maxNumContacts);
        found.cfm = Contacts::getConstraintForceMixing();
        found.erp = Contacts::getErrorReductionParameter();
        found.error_allowance = Contacts::getErrorAllowance();
        found.max_erv = Contacts::getMaxErrorReductionVelocity();
        found.fcl_primitives = false; /* the constructor of ConstraintSolver sets MESH */
        return found;
    }();
    return defaults;
}

pl_status pl_dart_world_create(const pl_dart_world_def *def, const pl_engine_setup *setup,
                               pl_dart_world **world, pl_error *error)
{
    *world = nullptr;
    pl_dart_defaults();
    try {
        auto made = std::make_unique<pl_dart_world>();
        made->setup = setup;
        made->def = *def;
        const pl_status status = fill(*made, error);
        if (status == PL_OK) {
            *world = made.release();
        }
        return status;
    } catch (const std::bad_alloc &) {
        return pl_engine_error(error, PL_NO_MEMORY, "out of memory for a DART world");
    } catch (...) {
        return pl_engine_error(error, PL_FAILED, "DART threw an exception while making a world");
    }
}

void pl_dart_world_destroy(pl_dart_world *world)
{
    delete world;
}

void pl_dart_add_force(pl_dart_world *world, int body, const double force[3],
                       const double offset[3])
{
    dynamics::BodyNode *node = world->bodies[static_cast<size_t>(body)];
    node->addExtForce(vector(force));
    node->addExtTorque(vector(offset).cross(vector(force)));
}

pl_status pl_dart_step(pl_dart_world *world, pl_step_stats *stats, double *rows, double *bytes)
{
    CountingSolver &solver = *world->solver;
    solver.groups = 0;
    solver.solve_time = 0;
    const double start = now();
    try {
        world->world->step();
    } catch (...) {
        return PL_FAILED;
    }
    const double elapsed = now() - start;
    if (solver.refused_rows > 0) {
        *rows = solver.refused_rows;
        *bytes = solver.refused_bytes;
        return PL_UNSUPPORTED;
    }
    stats->contacts = static_cast<double>(solver.contacts());
    stats->islands = solver.groups;
    stats->time_solve = solver.solve_time;
    stats->time_other = elapsed - solver.solve_time;
    return PL_OK;
}

void pl_dart_read_body(const pl_dart_world *world, int body, pl_body_state *state)
{
    const dynamics::BodyNode *node = world->bodies[static_cast<size_t>(body)];
    const Eigen::Isometry3d &pose = node->getWorldTransform();
    const Eigen::Quaterniond q(pose.linear());
    store(pose.translation(), state->position);
    store(node->getLinearVelocity(), state->velocity);
    store(node->getAngularVelocity(), state->angular_velocity);
    state->orientation[0] = q.w();
    state->orientation[1] = q.x();
    state->orientation[2] = q.y();
    state->orientation[3] = q.z();
}

void pl_dart_read_settings(const pl_dart_world *world, pl_engine_settings *settings)
{
    store(world->world->getGravity(), settings->gravity);
    settings->dt = world->world->getTimeStep();
    settings->linear_damping = 0;
    settings->angular_damping = 0;
    for (int i = 0; i < settings->body_count; ++i) {
        const dynamics::BodyNode *node = world->bodies[static_cast<size_t>(i)];
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

void pl_dart_read_pair(const pl_dart_world *world, int body_a, int body_b,
                       pl_pair_coefficients *found)
{
    const pl_body *bodies = world->setup->scene->bodies;
    const auto *a = surface_of(*world, body_a, bodies[body_b].material);
    const auto *b = surface_of(*world, body_b, bodies[body_a].material);
    found->friction = NAN;
    found->restitution = NAN;
    if (a != nullptr && b != nullptr) {
        found->friction = std::fmin(a->getPrimaryFrictionCoeff(), b->getPrimaryFrictionCoeff());
        found->restitution = a->getRestitutionCoeff() * b->getRestitutionCoeff();
    }
}

int pl_dart_read_contacts(const pl_dart_world *world, pl_contact *contacts, int capacity)
{
    const auto &found = world->world->getLastCollisionResult();
    int count = 0;
    for (std::size_t i = 0; i < found.getNumContacts(); ++i) {
        if (is_solved(found.getContact(i))) {
            if (count < capacity) {
                convert_contact(*world, found.getContact(i), contacts[count]);
            }
            ++count;
        }
    }
    return count;
}
