/* The variables of mutant.h. Every program and plug-in has its own, and sets them when it is loaded. */
#include "mutant.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

enum { MOST_MUTATIONS = 4096 };

static unsigned char unread[MOST_MUTATIONS];

int plumb_active_mutation;
unsigned char *plumb_reached_mutations = unread;

__attribute__((constructor)) static void set_mutation(void)
{
    const char *number = getenv("PLUMB_MUTATION"), *path = getenv("PLUMB_MUTATIONS_REACHED");
    plumb_active_mutation = number == NULL ? 0 : atoi(number);
    const int file = path == NULL ? -1 : open(path, O_RDWR | O_CLOEXEC);
    if (file < 0) {
        return;
    }
    void *shared = mmap(NULL, MOST_MUTATIONS, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    plumb_reached_mutations = shared == MAP_FAILED ? unread : shared;
    close(file);
}
