#include "schedule.h"

static int least(int a, int b)
{
    return a < b ? a : b;
}

bool pl_schedule_has_room(const pl_schedule *s, int threads)
{
    return s->runs < s->jobs && least(threads, s->cpus) <= s->cpus - s->busy_cpus;
}

int pl_schedule_begin(pl_schedule *s, int threads)
{
    const int needed = least(threads, s->cpus);
    const int share = least(s->cpus / s->jobs, s->cpus - s->busy_cpus);
    const int taken = share > needed ? share : needed;
    s->runs += 1;
    s->busy_cpus += taken;
    return taken;
}

void pl_schedule_end(pl_schedule *s, int cpus)
{
    s->runs -= 1;
    s->busy_cpus -= cpus;
}
