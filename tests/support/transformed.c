#include "transformed.h"

#include "check.h"
#include "plumb/vec.h"

pl_scene transformed(const pl_transform *transform, const pl_scene *from)
{
    pl_scene to;
    pl_error error = {.message = ""};
    if (pl_transform_scene(transform, from, &to, &error) != PL_OK) {
        fail_msg("%s: %s", from->name, error.message);
    }
    return to;
}

pl_transform transform_of(const pl_check *check, const pl_scene *scene)
{
    pl_transform transform;
    if (pl_check_transform(check, scene, &transform) != NULL) {
        transform = pl_transform_identity();
    }
    return transform;
}

void assert_vectors(const double actual[3], const double expected[3], double absolute,
                    double relative)
{
    double length = pl_vec_length(pl_vec_of(expected));
    for (int i = 0; i < 3; ++i) {
        assert_close(actual[i], expected[i], absolute + relative * length, 0);
    }
}
