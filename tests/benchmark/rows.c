/* Sort and sweep (Baraff 1992) in rows, in the benchmark alone: the engine's broad phase is a tree.
 *
 * Bodies are swept along the axis on which their centres are spread widest. Along one axis alone
 * every brick of a wall would meet the whole column above it, so the plane of the two other axes is
 * cut into cells no smaller than the bodies: boxes whose low corners fall into one cell make a row,
 * and a box can only meet those of its own row and of the eight around it. Rows are found by
 * hashing, so bodies may be anywhere. The few boxes larger than a cell make a row of their own,
 * which meets all. */
#include "rows.h"

#include "model/shape.h"

#include <string.h>

/* The axis, 0 to 2, along which the centres have the largest variance. */
static int widest_axis(const pe_world *world, const int *order, int count)
{
    pe_vec3 sum = {0}, squares = {0};
    for (int i = 0; i < count; ++i) {
        pe_vec3 x = pe_poses(world)[order[i]].position;
        sum = pe_add(sum, x);
        squares = pe_add(squares, pe_mul(x, x));
    }
    pe_vec3 spread = pe_sub(squares, pe_scale(1.0 / count, pe_mul(sum, sum)));
    return spread.x >= spread.y && spread.x >= spread.z ? 0 : spread.y >= spread.z ? 1 : 2;
}

/* The bounds of a body with its margin. Axis 0 is the one swept along, 1 and 2 are the next two. */
typedef struct box {
    double low[3], high[3];
    int slot;
    bool is_static;
} box;

/* Boxes in rows, each sorted by (low[0], slot). Row 0 has those that are larger than a cell. */
typedef struct rows {
    box *boxes;          /* (box_count) */
    int *start;          /* (count + 1): row r has boxes start[r] .. start[r + 1] - 1 */
    int32_t (*cell)[2];  /* (count): indices of its cell along axes 1 and 2 */
    int *table;          /* (table_size): hashed rows, 0: free */
    uint32_t table_size; /* a power of 2 */
    int count, box_count;
    int axis; /* of the world, along which is swept */
    double cell_size[2];
} rows;

static void fill_box(const pe_world *world, int slot, double dt, double slack, int axis, box *b)
{
    const pe_pose *pose = &pe_poses(world)[slot];
    /* The whole slack for each, because a plane has no bounds to hold a half of it. */
    double speed = pe_length(pe_twists(world)[slot].velocity) + pe_spin_speed(world, slot);
    double margin = dt * speed + slack;
    const pe_body *body = &pe_bodies(world)[slot];
    pe_extent bounds = pe_shape_extent(&body->shape, body->geometry, &pose->rotation);
    pe_vec3 e = bounds.half, x = pe_add(pose->position, bounds.centre);
    double centre[3] = {x.x, x.y, x.z}, extent[3] = {e.x, e.y, e.z};
    for (int k = 0; k < 3; ++k) {
        int q = (k + 3 - axis) % 3;
        b->low[q] = centre[k] - (extent[k] + margin);
        b->high[q] = centre[k] + (extent[k] + margin);
    }
    b->slot = slot;
    b->is_static = pe_bodies(world)[slot].is_static;
}

/* Cells hold the largest box, or one of twice the mean where few are larger. The slight excess is
 * for the rounding of cell indices. */
static void choose_cells(const box *boxes, int count, double cell_size[2])
{
    double sum[2] = {0}, largest[2] = {0};
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < 2; ++k) {
            double length = boxes[i].high[k + 1] - boxes[i].low[k + 1];
            sum[k] += length;
            largest[k] = pe_max(largest[k], length);
        }
    }
    for (int k = 0; k < 2; ++k) {
        cell_size[k] = 1.001 * pe_min(largest[k], 2 * sum[k] / count);
    }
}

/* The floor, within bounds. */
static int32_t cell_index(double x)
{
    const double most = 1 << 30;
    double held = pe_min(pe_max(x, -most), most);
    int32_t i = (int32_t)held;
    return i - (held < i);
}

/* The row of a cell; when there is none, a new one if `make`, else -1. */
static int row_of(rows *r, int32_t i, int32_t j, bool make)
{
    uint32_t hash = (uint32_t)i * 2654435761u ^ (uint32_t)j * 2246822519u;
    hash ^= hash >> 15;
    for (uint32_t k = hash & (r->table_size - 1);; k = (k + 1) & (r->table_size - 1)) {
        int row = r->table[k];
        if (row == 0) {
            if (!make) {
                return -1;
            }
            r->table[k] = r->count;
            r->cell[r->count][0] = i;
            r->cell[r->count][1] = j;
            return r->count++;
        }
        if (r->cell[row][0] == i && r->cell[row][1] == j) {
            return row;
        }
    }
}

static int row_of_box(rows *r, const box *b)
{
    for (int k = 0; k < 2; ++k) {
        /* Not <=, so that a box that is not finite is a large one. */
        if (!(1.0005 * (b->high[k + 1] - b->low[k + 1]) <= r->cell_size[k])) {
            return 0;
        }
    }
    return row_of(r, cell_index(b->low[1] / r->cell_size[0]),
                  cell_index(b->low[2] / r->cell_size[1]), true);
}

/* The order of the last step is nearly right, which insertion likes. */
static void sort_row(box *boxes, int count)
{
    for (int i = 1; i < count; ++i) {
        if (!(boxes[i - 1].low[0] > boxes[i].low[0]) &&
            !(boxes[i - 1].low[0] == boxes[i].low[0] && boxes[i - 1].slot > boxes[i].slot)) {
            continue;
        }
        box b = boxes[i];
        int j = i;
        for (; j > 0; --j) {
            const box *p = &boxes[j - 1];
            if (!(p->low[0] > b.low[0]) && !(p->low[0] == b.low[0] && p->slot > b.slot)) {
                break;
            }
            boxes[j] = *p;
        }
        boxes[j] = b;
    }
}

/* Leaves the order of the boxes for the next step. */
static pe_status make_rows(pe_world *world, int *order, int n, double dt, rows *r, pe_error *error)
{
    *r = (rows){.count = 1, .box_count = n, .table_size = 16};
    while (r->table_size < 2 * (uint32_t)n) {
        r->table_size *= 2;
    }
    size_t most = (size_t)n + 1;
    box *boxes = pe_scratch(world, most, sizeof *boxes);
    int *row = pe_scratch(world, most, sizeof *row);
    r->boxes = pe_scratch(world, most, sizeof *r->boxes);
    r->start = pe_scratch(world, most + 2, sizeof *r->start);
    r->cell = pe_scratch(world, most, sizeof *r->cell);
    r->table = pe_scratch(world, r->table_size, sizeof *r->table);
    if (boxes == NULL || row == NULL || r->boxes == NULL || r->start == NULL || r->cell == NULL ||
        r->table == NULL) {
        return pe_fail(error, PE_NO_MEMORY, "no memory for the bounds of %d bodies", n);
    }
    memset(r->table, 0, r->table_size * sizeof *r->table);
    memset(r->start, 0, (most + 2) * sizeof *r->start);
    r->axis = n > 0 ? widest_axis(world, order, n) : 0;
    double slack = pe_margin_slack(world, dt);
    for (int i = 0; i < n; ++i) {
        fill_box(world, order[i], dt, slack, r->axis, &boxes[i]);
    }
    choose_cells(boxes, n, r->cell_size);
    /* A counting sort by row: start[row + 2] counts, then start[row + 1] is where the next goes. */
    for (int i = 0; i < n; ++i) {
        row[i] = row_of_box(r, &boxes[i]);
        r->start[row[i] + 2] += 1;
    }
    for (int k = 2; k <= r->count + 1; ++k) {
        r->start[k] += r->start[k - 1];
    }
    for (int i = 0; i < n; ++i) {
        r->boxes[r->start[row[i] + 1]++] = boxes[i];
    }
    for (int k = 0; k < r->count; ++k) {
        sort_row(r->boxes + r->start[k], r->start[k + 1] - r->start[k]);
    }
    for (int i = 0; i < n; ++i) {
        order[i] = r->boxes[i].slot;
    }
    return PE_OK;
}

/* Pairs of `b` with those of the boxes, sorted by low[0], that begin before it ends. */
static pe_status meet(const box *b, const box *boxes, const box *end, pe_pair_list *list,
                      pe_error *error)
{
    pe_status status = PE_OK;
    for (const box *p = boxes; p < end && p->low[0] <= b->high[0] && status == PE_OK; ++p) {
        if (p->low[1] <= b->high[1] && b->low[1] <= p->high[1] && p->low[2] <= b->high[2] &&
            b->low[2] <= p->high[2] && !(p->is_static && b->is_static)) {
            status = pe_pair_list_add(list, p->slot, b->slot, error);
        }
    }
    return status;
}

static pe_status sweep_row(const rows *r, int row, pe_pair_list *list, pe_error *error)
{
    const box *end = r->boxes + r->start[row + 1];
    pe_status status = PE_OK;
    for (const box *b = r->boxes + r->start[row]; b < end && status == PE_OK; ++b) {
        status = meet(b, b + 1, end, list, error);
    }
    return status;
}

/* Pairs across two rows: each is met by the box that begins first. */
static pe_status sweep_two_rows(const rows *r, int row_p, int row_q, pe_pair_list *list,
                                pe_error *error)
{
    const box *p = r->boxes + r->start[row_p], *end_p = r->boxes + r->start[row_p + 1];
    const box *q = r->boxes + r->start[row_q], *end_q = r->boxes + r->start[row_q + 1];
    pe_status status = PE_OK;
    while (p < end_p && q < end_q && status == PE_OK) {
        if (p->low[0] <= q->low[0]) {
            status = meet(p++, q, end_q, list, error);
        } else {
            status = meet(q++, p, end_p, list, error);
        }
    }
    return status;
}

static pe_status sweep(rows *r, pe_pair_list *list, pe_error *error)
{
    static const int32_t forward[4][2] = {{0, 1}, {1, -1}, {1, 0}, {1, 1}};
    pe_status status = sweep_row(r, 0, list, error);
    for (int row = 1; row < r->count && status == PE_OK; ++row) {
        status = sweep_row(r, row, list, error);
        if (status == PE_OK) {
            status = sweep_two_rows(r, 0, row, list, error);
        }
        for (int k = 0; k < 4 && status == PE_OK; ++k) {
            int other =
                row_of(r, r->cell[row][0] + forward[k][0], r->cell[row][1] + forward[k][1], false);
            if (other > 0) {
                status = sweep_two_rows(r, row, other, list, error);
            }
        }
    }
    return status;
}

/* The bounds of dynamic bodies hold their margin already. */
static pe_status sweep_plane(const pe_world *world, const rows *r, int plane, pe_pair_list *list,
                             pe_error *error)
{
    const pe_shape *shape = &pe_bodies(world)[plane].shape;
    double normal[3] = {shape->normal.x, shape->normal.y, shape->normal.z}, n[3];
    for (int k = 0; k < 3; ++k) {
        n[k] = normal[(r->axis + k) % 3];
    }
    for (int i = 0; i < r->box_count; ++i) {
        const box *b = &r->boxes[i];
        double deepest = 0;
        for (int k = 0; k < 3; ++k) {
            deepest += n[k] * (n[k] > 0 ? b->low[k] : b->high[k]);
        }
        if (!b->is_static && deepest <= shape->offset) {
            pe_status status = pe_pair_list_add(list, plane, b->slot, error);
            if (status != PE_OK) {
                return status;
            }
        }
    }
    return PE_OK;
}

pe_status pe_rows_find(pe_world *world, int *order, int order_count, double dt, pe_pair **pairs,
                       int *count, pe_error *error)
{
    rows r;
    pe_status status = make_rows(world, order, order_count, dt, &r, error);
    pe_pair_list list = {.work = pe_step_memory(world)};
    if (status == PE_OK) {
        status = sweep(&r, &list, error);
    }
    for (int slot = 1; slot < world->slot_count && status == PE_OK; ++slot) {
        const pe_body *body = &pe_bodies(world)[slot];
        if (body->alive && body->shape.kind == PE_SHAPE_PLANE) {
            status = sweep_plane(world, &r, slot, &list, error);
        }
    }
    if (status == PE_OK) {
        status = pe_pair_list_sort(&list, world->slot_count, error);
    }
    *pairs = list.items;
    *count = list.count;
    return status;
}
