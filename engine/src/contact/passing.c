/* Two convex bodies in straight relative motion do not collide before the last of the directions that
 * separate them stops doing so (Ericson 2005, Real-Time Collision Detection, 5.5.8). The direction
 * whose gap closes last is the normal of the impact. If it does not close in the step, the bodies pass.
 *
 * The narrow phase gives the direction of the largest gap now. For a body that slides from one floor
 * tile to the next this is the direction of motion, with the side of the next tile as the obstacle.
 * The direction that matters is the normal of the common floor, along which there is no gap. Where the
 * motion will have taken the body, it is the one that the narrow phase gives. So the pair is collided
 * there, and the manifold is moved back.
 *
 * A body that rests on others lies a little deeper than their surfaces, by what position correction
 * leaves. So an overlap up to that depth counts as a gap of zero. */
#include "passing.h"

#include "narrow_phase/tolerances.h"

#include <string.h>

/* Times at which the pair is collided: after the step, and then earlier by halves. The pair may be past
 * each other by then. */
enum { MOST_LOOKS = 3 };

/* Cosine of the angle, 6 degrees, up to which a contact is the one that pushed in the last step. The
 * normal of edges that begin to meet is farther from those of their faces. */
static const double SAME_NORMAL = 0.995;

/* The speed at which the gap at a point opens, m/s. */
static double opening_speed(const pe_approach *p, pe_vec3 normal, pe_vec3 point)
{
    const pe_vec3 ra = pe_sub(point, p->a.pose->position), rb = pe_sub(point, p->b.pose->position);
    const pe_vec3 va = pe_add(p->of_a.velocity, pe_cross(p->of_a.angular_velocity, ra));
    const pe_vec3 vb = pe_add(p->of_b.velocity, pe_cross(p->of_b.angular_velocity, rb));
    return pe_dot(normal, pe_sub(vb, va));
}

/* Whether all points lie on a line, within twice `width`. Bodies that touch along an area are
 * separated by no direction other than its normal. */
static bool is_line(const pe_pair_manifold *m, double width)
{
    const pe_vec3 from = m->item[0].position;
    pe_vec3 along = pe_v3(0, 0, 0);
    double longest = 0;
    for (int k = 1; k < m->count; ++k) {
        const pe_vec3 d = pe_sub(m->item[k].position, from);
        if (pe_dot(d, d) > longest) {
            longest = pe_dot(d, d);
            along = d;
        }
    }
    for (int k = 1; k < m->count; ++k) {
        const pe_vec3 aside = pe_cross(along, pe_sub(m->item[k].position, from));
        if (pe_dot(aside, aside) > 4 * width * width * longest) {
            return false;
        }
    }
    return true;
}

/* Whether a contact along nearly the same normal pushed in the last step. */
static bool has_pushed(const pe_approach *p, pe_vec3 normal)
{
    for (int i = 0; i < p->old_count; ++i) {
        const pe_manifold *m = &p->old[i];
        for (int k = m->first; k < m->first + m->count && pe_dot(m->normal, normal) > SAME_NORMAL;
             ++k) {
            if (pe_dot(p->old_points[k].impulse, m->normal) > 0) {
                return true;
            }
        }
    }
    return false;
}

/* Whether a point of the manifold closes in the step, by more than `least`, to less than `gap` (m;
 * below 0 it overlaps). */
static bool closes(const pe_approach *p, const pe_pair_manifold *m, double least, double gap)
{
    for (int k = 0; k < m->count; ++k) {
        const double way = p->dt * opening_speed(p, m->normal, m->item[k].position);
        if (way < -least && m->item[k].separation + way < gap) {
            return true;
        }
    }
    return false;
}

/* Whether a new contact at an edge or a corner closes in the step. */
static bool is_due(const pe_approach *p, const pe_pair_manifold *manifolds, int count, double least,
                   double width)
{
    for (int i = 0; i < count; ++i) {
        const pe_pair_manifold *m = &manifolds[i];
        if (closes(p, m, least, least + p->fall) && is_line(m, width) &&
            !has_pushed(p, m->normal)) {
            return true;
        }
    }
    return false;
}

/* The least separation of a point, m; HUGE_VAL if there is none. */
static double least_separation(const pe_pair_manifold *manifolds, int count)
{
    double least = HUGE_VAL;
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < manifolds[i].count; ++k) {
            least = pe_min(least, manifolds[i].item[k].separation);
        }
    }
    return least;
}

/* Moves what was found at b's pose after `shift` (m, world) back to that before. The points move with
 * the smaller body, whose lever arms then are those of its surface. */
static void move_back(const pe_approach *p, pe_vec3 shift, pe_pair_manifold *manifolds, int count)
{
    const pe_vec3 back = p->b.size < p->a.size ? pe_scale(-1, shift) : pe_v3(0, 0, 0);
    for (int i = 0; i < count; ++i) {
        for (int k = 0; k < manifolds[i].count; ++k) {
            pe_pair_point *point = &manifolds[i].item[k];
            point->separation -= pe_dot(manifolds[i].normal, shift);
            point->position = pe_add(point->position, back);
        }
    }
}

/* Whether these manifolds keep the pair apart for the whole step, up to an overlap of `slack`, and by no
 * wide gap: a body that others deflect in the step would cross it unnoticed. */
static bool keep_apart(const pe_approach *p, const pe_pair_manifold *manifolds, int count,
                       double least, double slack)
{
    const double gap = least_separation(manifolds, count);
    bool apart = gap >= -slack && gap <= PE_PASSING_GAP * pe_min(p->a.size, p->b.size) + slack;
    for (int i = 0; i < count && apart; ++i) {
        apart = !closes(p, &manifolds[i], least, -slack);
    }
    return apart;
}

bool pe_pass(const pe_approach *p, pe_workspace work, pe_pair_manifold *manifolds, int *count)
{
    const pe_vec3 velocity = pe_sub(p->of_b.velocity, p->of_a.velocity);
    const double speed = pe_length(velocity), size = pe_min(p->a.size, p->b.size);
    const double least = PE_PASSING * size, slack = least + p->depth;
    if (!(size > 0) || !(speed > 0) || !is_due(p, manifolds, *count, least, slack)) {
        return true;
    }
    /* By then edges that meet at the end of the step have passed. */
    double time = p->dt + (p->fall + 4 * PE_EDGES_MEET * size) / speed;
    for (int look = 0; look < MOST_LOOKS; ++look, time *= 0.5) {
        const pe_vec3 shift = pe_scale(time, velocity);
        pe_pair_manifold found[PE_MAX_MANIFOLDS];
        pe_pose moved = *p->b.pose;
        pe_placed b = p->b;
        moved.position = pe_add(moved.position, shift);
        b.pose = &moved;
        const int n = pe_collide(p->a, b, p->margin, work, found);
        if (n < 0) {
            return false;
        }
        if (least_separation(found, n) < -slack) {
            break; /* an impact */
        }
        move_back(p, shift, found, n);
        if (keep_apart(p, found, n, least, slack)) {
            memcpy(manifolds, found, (size_t)n * sizeof *found);
            *count = n;
            break;
        }
    }
    return true;
}
