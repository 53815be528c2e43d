/* The pictures of a problem: its scene, rebuilt, with where every engine left the bodies. */
#ifndef PLUMB_PICTURE_H
#define PLUMB_PICTURE_H

#include "base/text_buffer.h"
#include "result_matrix.h"

/* Writes a <figure> for every engine that has a run of the block, or one paragraph that says why
 * there are no pictures: the scene cannot be rebuilt, or is not the one that was run. `index` is
 * the block's, unique in the page. */
void pl_picture_row(const pl_result_matrix *cells, int index, pl_text_buffer *out);

/* Rebuilds the scene of a block: from the catalogue, or from the scene file by its path, with the
 * step and the duration of the run. PL_FAILED when its hash is not that of the results. The caller
 * frees. */
pl_status pl_picture_scene(const pl_block *block, pl_scene *scene, pl_error *error);

#endif
