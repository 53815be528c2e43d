/* The built-in engines' descriptors, one adapter file each. Static storage, never NULL. An adapter
 * whose engine is absent from this build is not compiled. */
#ifndef PLUMB_ADAPTERS_H
#define PLUMB_ADAPTERS_H

#include "plumb/engine_abi.h"

const pl_engine *pl_engine_plumb(void);
const pl_engine *pl_engine_ode(void);
const pl_engine *pl_engine_bullet(void);

#endif
