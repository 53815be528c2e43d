/* DART 6.12.
 *
 * A profile is a solver and a collision detector. `default` is dart::simulation::World as its
 * constructor makes it: FCL on triangles, Dantzig's method, and PGS for a group where Dantzig fails. `pgs`
 * has PGS alone, with nothing behind it. The others have the default's solver with another
 * detector. Bullet's is left out: libdart-collision-bullet needs Bullet in single precision, whose
 * libraries define 2146 of the symbols of those in double precision, such as
 * btTransform::getIdentity's object, which the dynamic linker makes one for a process.
 *
 * recommended: ODE's detector, with more contacts, as Gazebo sets DART up, whose plugin DART's
 * releases are tested with. What DART's authors advise for contacts is Bullet's detector (issues
 * 860, 1065 and 1183 of dartsim/dart), which Gazebo had before. The sources in engine.json have the
 * citations.
 *
 * DART has no sleeping and no damping of its own. Its default step is 1/1000 s (World.cpp); here it
 * is the scene's. */
#include "adapters/native.h"

#include <dart_description.h>

PL_ENGINE_FUNCTIONS(dart)
PL_ENGINE(plumb_engine, dart)
