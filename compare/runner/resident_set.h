/* Growth of this process's resident memory, from Linux's /proc/self (proc(5): clear_refs, status).
 */
#ifndef PLUMB_RESIDENT_H
#define PLUMB_RESIDENT_H

/* Gives unused heap back, loads the code that a run may come to, resets the peak, and returns the
 * resident set now, in bytes; NAN where /proc cannot tell. */
double pl_resident_set_baseline(void);

/* Bytes by which the peak since then lies above `baseline`; NAN where it cannot be told. */
double pl_resident_set_growth(double baseline);

#endif
