/* The page's style out. */
#ifndef PLUMB_STYLE_H
#define PLUMB_STYLE_H

/* CSS rules, NULL-terminated: light and dark by the reader's preference, print, narrow screens, and
 * the pictures' colours. */
extern const char *const pl_style[];

#endif
