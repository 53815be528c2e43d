#include "brick_wall.h"

/* `length` is that along x; density is the same for half bricks. */
static void build_brick(pl_builder *builder, int row, int place, double x, double length,
                        bool expect_rest)
{
    pl_body brick = pl_body_default();
    brick.mass = length / PL_BRICK_LENGTH;
    brick.shape = pl_shape_box(length / 2, PL_BRICK_HEIGHT / 2, PL_BRICK_HEIGHT / 2);
    brick.position[0] = x;
    brick.position[2] = (row + 0.5) * PL_BRICK_HEIGHT;
    int index = pl_build_body(builder, &brick, "brick %d.%d", row + 1, place + 1);
    if (expect_rest) {
        pl_build_rest(builder, index);
    }
}

void pl_build_brick_wall(pl_builder *builder, int rows, int columns, bool expect_rest)
{
    const double half = PL_BRICK_LENGTH / 2;
    pl_build_floor(builder, 0, 0, 1, 0);
    for (int row = 0; row < rows; row++) {
        if (row % 2 == 0) {
            for (int c = 0; c < columns; c++) {
                build_brick(builder, row, c, c, PL_BRICK_LENGTH, expect_rest);
            }
            continue;
        }
        build_brick(builder, row, 0, -half / 2, half, expect_rest);
        for (int c = 1; c < columns; c++) {
            build_brick(builder, row, c, c - half, PL_BRICK_LENGTH, expect_rest);
        }
        build_brick(builder, row, columns, columns - half - half / 2, half, expect_rest);
    }
}
