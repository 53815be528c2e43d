/* When a scene comes to rest: the first time from which every body stays below 1 mm/s and 1 mrad/s
 * for 0.5 s. */
#ifndef PLUMB_SETTLE_H
#define PLUMB_SETTLE_H

#include "plumb/engine_abi.h"

typedef struct pl_settle {
    const pl_scene *scene;
    long hold;        /* steps that make 0.5 s */
    long quiet_since; /* first step of the quiet that lasts; -1 while something moves */
    bool settled;     /* the quiet has lasted 0.5 s: quiet_since is final */
} pl_settle;

/* `scene` must outlive it. */
pl_settle pl_settle_start(const pl_scene *scene);

/* The state after step number `step` (0: before the first). True when the quiet begins with it. */
bool pl_settle_see(pl_settle *settle, long step, const pl_body_state *bodies);

#endif
