/* Angles of parameters are in degrees. */
#ifndef PLUMB_DEGREE_H
#define PLUMB_DEGREE_H

#define PL_RADIANS_PER_DEGREE 0.017453292519943295 /* pi / 180 */

#endif
