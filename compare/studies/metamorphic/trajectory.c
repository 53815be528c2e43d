#include "trajectory.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

pl_status pl_trajectory_open(pl_trajectory *trajectory, pl_error *error)
{
    *trajectory = (pl_trajectory){.file = tmpfile()};
    return trajectory->file == NULL
               ? pl_fail(error, PL_IO, "no temporary file for a trajectory: %s", strerror(errno))
               : PL_OK;
}

void pl_trajectory_close(pl_trajectory *trajectory)
{
    if (trajectory->file != NULL) {
        fclose(trajectory->file);
    }
    free(trajectory->frame.bodies);
    free(trajectory->line);
    *trajectory = (pl_trajectory){.file = NULL};
}

pl_status pl_trajectory_rewind(pl_trajectory *trajectory, int body_count, pl_error *error)
{
    pl_trajectory *t = trajectory;
    size_t size = ((size_t)body_count + 1) * sizeof *t->frame.bodies;
    pl_body_state *bodies = realloc(t->frame.bodies, size);
    if (bodies == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory for %d bodies", body_count);
    }
    t->frame = (pl_frame){.body_count = body_count, .bodies = bodies};
    rewind(t->file);
    /* The header. */
    (void)!getline(&t->line, &t->capacity, t->file);
    return PL_OK;
}

/* What follows the quoted name that begins at `text`, in which quotes are doubled; NULL where it
 * has no end. */
static const char *after_name(const char *text)
{
    if (*text++ != '"') {
        return NULL;
    }
    for (; *text != '\0'; ++text) {
        if (*text == '"') {
            if (text[1] != '"') {
                return text + 1;
            }
            ++text;
        }
    }
    return NULL;
}

/* `count` numbers, each after a comma. */
static const char *read_numbers(const char *text, double *numbers, int count)
{
    for (int i = 0; i < count && text != NULL; ++i) {
        char *end = NULL;
        if (*text != ',') {
            return NULL;
        }
        numbers[i] = strtod(text + 1, &end);
        text = end == text + 1 ? NULL : end;
    }
    return text;
}

static bool read_line(pl_trajectory *t, pl_body_state *body)
{
    if (getline(&t->line, &t->capacity, t->file) < 0) {
        return false;
    }
    char *end = NULL;
    t->frame.time = strtod(t->line, &end);
    const char *text = *end == ',' ? after_name(end + 1) : NULL;
    text = text == NULL ? NULL : read_numbers(text, body->position, 3);
    text = text == NULL ? NULL : read_numbers(text, body->orientation, 4);
    text = text == NULL ? NULL : read_numbers(text, body->velocity, 3);
    text = text == NULL ? NULL : read_numbers(text, body->angular_velocity, 3);
    return text != NULL && *text == '\n';
}

bool pl_trajectory_next(pl_trajectory *trajectory)
{
    bool whole = true;
    for (int i = 0; i < trajectory->frame.body_count && whole; ++i) {
        whole = read_line(trajectory, &trajectory->frame.bodies[i]);
    }
    return whole;
}
