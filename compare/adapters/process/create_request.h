/* The request `create` of the protocol plumb.engine/1: a scene with every number that an engine
 * needs. */
#ifndef PLUMB_CREATE_REQUEST_H
#define PLUMB_CREATE_REQUEST_H

#include "base/text_buffer.h"
#include "plumb/engine_abi.h"

/* Adds the members of the request, each with a comma before it. The options are those of `engine`,
 * with the values of the setup. Out of memory: out->failed. */
void pl_create_request_add(pl_text_buffer *out, const pl_engine_setup *setup,
                           const pl_engine *engine);

#endif
