#include "domino.h"

#include <math.h>

const double pl_domino_half[3] = {0.075, 0.25, 0.5};

void pl_build_dominoes(pl_builder *builder, int count, double size, double spacing, double push)
{
    const double x = pl_domino_half[0] * size, y = pl_domino_half[1] * size;
    const double z = pl_domino_half[2] * size, reach = sqrt(x * x + z * z);
    const double g = -builder->scene->gravity[2];
    const double spin = push * sqrt(1.5 * g * (reach - z)) / reach;
    for (int i = 0; i < count; i++) {
        pl_body domino = pl_body_default();
        domino.shape = pl_shape_box(x, y, z);
        domino.position[0] = i * spacing * size;
        domino.position[2] = z;
        if (i == 0) {
            domino.angular_velocity[1] = spin;
            domino.velocity[0] = spin * z;
            domino.velocity[2] = spin * x;
        }
        pl_build_body(builder, &domino, "domino %d", i + 1);
    }
}
