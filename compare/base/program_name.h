/* The name of this program, which is also the key of its build in what it writes. */
#ifndef PLUMB_PROGRAM_NAME_H
#define PLUMB_PROGRAM_NAME_H

#define PL_PROGRAM "plumb"

#endif
