/* Pictures of a scene as inline SVG for an HTML page. Colours are the page's: classes d0..d5
 * (moving bodies, dark to light), s0..s5 (static), f0..f5 (fallen), fine (a facet of a body that is
 * no box), ground, expected, start. Hulls and meshes are drawn without details below 5 px. */
#ifndef PLUMB_SVG_H
#define PLUMB_SVG_H

#include "base/text_buffer.h"
#include "view.h"

/* The dashed outlines of what is expected, as a hidden <svg> with one <path id="`id`"> that the
 * pictures of this scene use. Where bodies are expected to travel, their start is a dotted outline
 * in it too. */
void pl_svg_expected(const pl_scene *scene, const pl_view *view, const char *id,
                     pl_text_buffer *buffer);

/* One picture: ground, expected outlines, then the bodies at poses[body_count] from back to front,
 * faces turned away and faces wholly covered left out. A body of `rests` beyond
 * scene.collapse_distance is drawn as fallen. `title` is the picture's alternative text. Returns
 * how many moving bodies lie wholly outside the frame. */
int pl_svg_picture(const pl_scene *scene, const pl_view *view, const pl_pose *poses,
                   const char *expected_id, const char *title, pl_text_buffer *buffer);

#endif
