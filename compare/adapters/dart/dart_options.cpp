/* DART 6.12.
 *
 * A profile is a solver and a collision detector. `default` is dart::simulation::World as it is
 * constructed: FCL on triangles, Dantzig's method, and PGS for a group where Dantzig fails. `pgs`
 * has PGS alone, with nothing behind it. The others have the default's solver with another
 * detector. Bullet's is left out: libdart-collision-bullet needs Bullet in single precision, whose
 * libraries define 2146 of the symbols of those in double precision, such as
 * btTransform::getIdentity's object, which the dynamic linker makes one for a process.
 *
 * recommended: ODE's detector, with more contacts, as Gazebo sets DART up, whose plugin DART's
 * releases are tested with. What DART's authors advise for contacts is Bullet's detector (issues
 * 860, 1065 and 1183 of dartsim/dart), which Gazebo had before. pl_dart_sources has the citations.
 *
 * DART has no sleeping and no damping of its own. Its default step is 1/1000 s (World.cpp); here it
 * is the scene's. */
#include "dart_options.h"

#include <dart/constraint/BoxedLcpConstraintSolver.hpp>
#include <dart/constraint/ContactConstraint.hpp>
#include <dart/constraint/PgsBoxedLcpSolver.hpp>

#include <algorithm>
#include <array>

#define STEP_CODE "world->setTimeStep({}); world->step();"

const pl_engine_profile pl_dart_profiles[PROFILE_COUNT] = {
    {"default", "World as constructed: Dantzig's method, FCL on triangles", true, STEP_CODE},
    {"pgs", "projected Gauss-Seidel in place of Dantzig's method", false, STEP_CODE},
    {"ode-collision", "the default with ODE's collision detector", false, STEP_CODE},
    {"dart-collision", "the default with DART's own collision detector: spheres and boxes", false,
     STEP_CODE},
    {"recommended", "Dantzig's method and ODE's detector, as Gazebo sets DART up", true, STEP_CODE},
};

/* A line of code that sets an option of PGS. */
#define PGS_CODE(assignment)                                                                       \
    "auto option = pgs->getOption(); option." assignment "; pgs->setOption(option);"
#define CONTACT_CODE(function) "dart::constraint::ContactConstraint::" function "({});"

enum { GAZEBO_MAX_CONTACTS = 10000 };

enum { ALL_PROFILES = (1 << PROFILE_COUNT) - 1, PGS_PROFILES = 1 << PROFILE_PGS };

const pl_engine_option pl_dart_options[OPTION_COUNT] = {
    {"iterations", 30, 1, 1e6, true, "1",
     "most sweeps of PGS; elsewhere of what Dantzig leaves to it", PGS_CODE("mMaxIteration = {}"),
     PGS_PROFILES, 1, 300, true},
    {"delta_x", 1e-6, 0, 1e6, false, "N s",
     "PGS ends after a first sweep that changes no impulse by more",
     PGS_CODE("mDeltaXThreshold = {}"), 0, 0, 0, false},
    {"relative_delta_x", 1e-3, 0, 1, false, "1",
     "PGS ends after a sweep that changes no impulse by more of it",
     PGS_CODE("mRelativeDeltaXTolerance = {}"), PGS_PROFILES, 1e-9, 1e-2, true},
    {"random_order", 0, 0, 1, true, "1", "every eighth sweep of PGS draws a new order of the rows",
     PGS_CODE("mRandomizeConstraintOrder = {}"), PGS_PROFILES, 0, 1, false},
    {"max_contacts", 1000, 1, 1e6, true, "1",
     "contact points of a step; those found later are dropped",
     "world->getConstraintSolver()->getCollisionOption().maxNumContacts = "
     "{};",
     0, 0, 0, false},
    {"cfm", 1e-5, 1e-9, 1, false, "1", "constraint force mixing: share added to the diagonal",
     CONTACT_CODE("setConstraintForceMixing"), ALL_PROFILES, 1e-9, 1e-3, true},
    {"erp", 0.01, 0, 1, false, "1", "share of the penetration undone in a step, at most at max_erv",
     CONTACT_CODE("setErrorReductionParameter"), ALL_PROFILES, 0.001, 1, true},
    {"error_allowance", 0, 0, 1e3, false, "m",
     "penetration that is not undone, where there is friction", CONTACT_CODE("setErrorAllowance"),
     ALL_PROFILES, 0, 0.002, false},
    {"max_erv", 1e-3, 0, 1e6, false, "m/s", "the fastest that penetration is undone",
     CONTACT_CODE("setMaxErrorReductionVelocity"), ALL_PROFILES, 1e-4, 10, true},
    {"fcl_primitives", 0, 0, 1, true, "1",
     "FCL's own spheres, boxes and planes, which DART advises against",
     "fcl->setPrimitiveShapeType(static_cast<dart::collision::"
     "FCLCollisionDetector::PrimitiveShape>(1 - {}));",
     0, 0, 0, false},
};

#define GAZEBO_PLUGIN                                                                              \
    "Gazebo's plugin for DART (https://github.com/gazebosim/gz-physics, "                          \
    "dartsim/src/EntityManagementFeatures.cc)"

const pl_engine_source pl_dart_sources[] = {
    {PROFILE_RECOMMENDED, NULL,
     "ODE's detector: \"setCollisionDetector(dart::collision::OdeCollisionDetector::create())\" "
     "of " GAZEBO_PLUGIN "; \"we started using Bullet ... and then ODE\" "
     "(https://github.com/gazebosim/gz-sim/pull/684). Bullet's, which DART's authors advise "
     "against inaccurate contact points (https://github.com/dartsim/dart/issues/860), cannot be "
     "loaded next to Bullet in double precision"},
    {PROFILE_RECOMMENDED, NULL,
     "Dantzig's method as shipped: \"Dantzig for exact solves\" of contacts with friction (DART, "
     "docs/background/lcp/07_selection-guide.md). PGS, which \"tends to provide more stable "
     "results\" (https://github.com/dartsim/dart/issues/1068), is the profile pgs: towers fall"},
    {PROFILE_RECOMMENDED, "max_contacts", "\"maxNumContacts = 10000\" of " GAZEBO_PLUGIN},
};

const int pl_dart_source_count = sizeof pl_dart_sources / sizeof pl_dart_sources[0];

void pl_dart_profile_defaults(int profile, double *values)
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
    if (profile == PROFILE_RECOMMENDED) {
        values[OPTION_MAX_CONTACTS] = GAZEBO_MAX_CONTACTS;
    }
}
