/* The adapter of the built-in engine. */
#ifndef PLUMB_ADAPTER_PLUMB_H
#define PLUMB_ADAPTER_PLUMB_H

#include "plumb/engine_abi.h"

/* Its table. Static storage, never NULL. */
const pl_engine *pl_engine_plumb(void);

#endif
