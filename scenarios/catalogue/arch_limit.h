/* The limit of a semicircular arch of voussoirs: the least thickness at which a line of thrust lies
 * within every joint. */
#ifndef PLUMB_ARCH_LIMIT_H
#define PLUMB_ARCH_LIMIT_H

/* Thickness over mean radius, for `count` >= 3 equal voussoirs with flat faces and radial joints,
 * the lowest of them level. Without sliding. */
double pl_arch_limit(int count);

/* From the centre of the arch of mean radius 1 to the centre of mass of a voussoir. */
double pl_voussoir_centre(int count, double thickness);

#endif
