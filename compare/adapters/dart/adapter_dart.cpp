/* The table of DART's adapter. */
#include "dart_options.h"
#include "dart_world.h"

/* The symbol that the harness looks up. */
extern "C" const pl_engine *plumb_engine(void);

const pl_engine *plumb_engine(void)
{
    static const pl_engine engine = [] {
        pl_engine e{};
        e.struct_size = sizeof e;
        e.abi_version = PL_ENGINE_ABI_VERSION;
        e.name = "dart";
        e.version = PLUMB_DART_VERSION;
        e.description = "DART, the Dynamic Animation and Robotics Toolkit";
        e.capabilities = PL_NEEDS_FRICTION | PL_NEEDS_RESTITUTION | PL_NEEDS_ROTATION |
                         PL_NEEDS_FORCES | PL_NEEDS_PLANE | PL_NEEDS_SPHERE | PL_NEEDS_BOX |
                         PL_NEEDS_CAPSULE | PL_NEEDS_CYLINDER | PL_NEEDS_HULL | PL_NEEDS_MESH;
        e.contacts = PL_CONTACTS_POINTS | PL_CONTACTS_IMPULSES;
        e.integrator = PL_INTEGRATOR_SEMI_IMPLICIT_EULER;
        e.gyroscopic = PL_GYROSCOPIC_EXPLICIT;
        e.substeps = 1;
        e.profiles = pl_dart_profiles;
        e.profile_count = PROFILE_COUNT;
        e.sources = pl_dart_sources;
        e.source_count = pl_dart_source_count;
        e.options = pl_dart_options;
        e.option_count = OPTION_COUNT;
        e.profile_defaults = pl_dart_profile_defaults;
        e.create = pl_dart_create;
        e.destroy = pl_dart_destroy;
        e.step = pl_dart_step;
        e.read_frame = pl_dart_read_frame;
        e.read_settings = pl_dart_read_settings;
        e.read_pair = pl_dart_read_pair;
        e.read_contacts = pl_dart_read_contacts;
        return e;
    }();
    return &engine;
}
