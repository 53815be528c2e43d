#include "metrics.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const pl_metric_info pl_metric_table[PL_METRIC_COUNT] = {
#define METRIC(id, name_, unit_, direction_, traits_, ...)                                         \
    [PL_METRIC_##id] = {.name = name_,                                                             \
                        .unit = unit_,                                                             \
                        .direction = direction_,                                                   \
                        .traits = traits_,                                                         \
                        .definition = __VA_ARGS__},
#include "metrics.def"
};

int pl_metric_by_name(const char *name)
{
    for (int i = 0; i < PL_METRIC_COUNT; ++i) {
        if (strcmp(pl_metric_table[i].name, name) == 0) {
            return i;
        }
    }
    return -1;
}

bool pl_metric_is(int id, unsigned traits)
{
    return id >= 0 && (pl_metric_table[id].traits & traits) != 0;
}

pl_metric pl_metric_value(double value)
{
    return (pl_metric){.state = PL_METRIC_VALUE, .value = value};
}

pl_metric pl_metric_failed(const char *format, ...)
{
    pl_metric metric = {.state = PL_METRIC_FAILED};
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(metric.reason, sizeof metric.reason, format, arguments);
    va_end(arguments);
    return metric;
}
