/* From the raw file of a run to plumb.recording/1.
 *
 * A drawn point may be off by L / 2000, where L is the diameter of the scene's dynamic bodies at the
 * start. A frame is dropped when the straight line between the frames that are kept around it is
 * within half of that for every body. Positions are rounded to L / 16000, and orientations so that the
 * farthest point of the largest body moves by less than L / 16000. The numbers are written as
 * differences from frame to frame, as variable-length integers, deflated (RFC 1951). */

#include "base/file_text.h"
#include "base/heap.h"
#include "base/text_buffer.h"
#include "recording.h"
#include "referee/geometry/solid.h"
#include "results/store.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

enum { LONGEST_GAP = 32, MOST_CONTACT_FRAMES = 40, MOST_CONTACTS = 400 };

/* A frame of the raw file, of which all pointers are unaligned. */
typedef struct raw_frame {
    int64_t step;
    const char *poses; /* (7 x bodies) floats */
    const char *contacts;
    int32_t contact_count; /* -1: none are reported */
} raw_frame;

typedef struct raw_curves {
    int64_t step;
    double value[PL_CURVE_COUNT];
} raw_curves;

/* Everything of one recording. */
typedef struct work {
    const pl_scene *scene;
    const char *run;
    int moving;    /* dynamic bodies */
    double radius; /* m: the largest bounding radius of one */
    double size;   /* m: the diameter of the scene */
    double bound;  /* m: what a drawn point may be off by */
    double position_unit, orientation_unit;
    raw_frame *frames; /* (frame_count) */
    int frame_count;
    int *kept; /* (kept_count): indices of frames */
    int kept_count;
    raw_curves *curves; /* (curve_count) */
    int curve_count;
    pl_text_buffer bytes; /* variable-length integers */
    pl_text_buffer out;
} work;

static float float_at(const char *floats, long index)
{
    float value;
    memcpy(&value, floats + index * (long)sizeof value, sizeof value);
    return value;
}

/* ---- Reading ---- */

/* Whether every pose is finite and not too far away to be drawn. */
static bool is_drawable(const work *w, const raw_frame *frame)
{
    for (long i = 0; i < 7L * w->moving; ++i) {
        const double value = (double)float_at(frame->poses, i);
        if (!(fabs(value) < (i % 7 < 3 ? 1e6 * w->size + 1e6 : 2))) {
            return false;
        }
    }
    return true;
}

/* Reads the record at *at; false at the end, at a record that is cut off, and where the run
 * diverged. */
static bool read_record(work *w, const char **at, const char *end)
{
    const long poses = 7L * w->moving * (long)sizeof(float), left = end - *at;
    const char kind = left > 0 ? **at : '\0';
    if (kind == 'C' && left >= 1 + (long)sizeof(raw_curves)) {
        raw_curves curves;
        memcpy(&curves, *at + 1, sizeof curves);
        *at += 1 + sizeof curves;
        pl_push(&w->curves, &w->curve_count, &curves, sizeof curves);
        return true;
    }
    raw_frame frame;
    const long head = 1 + (long)sizeof frame.step + poses + (long)sizeof frame.contact_count;
    if (kind != 'F' || left < head) {
        return false;
    }
    memcpy(&frame.step, *at + 1, sizeof frame.step);
    frame.poses = *at + 1 + sizeof frame.step;
    memcpy(&frame.contact_count, frame.poses + poses, sizeof frame.contact_count);
    frame.contacts = *at + head;
    const long contacts =
        frame.contact_count > 0 ? 5L * frame.contact_count * (long)sizeof(float) : 0;
    if (left < head + contacts || !is_drawable(w, &frame)) {
        return false;
    }
    *at += head + contacts;
    pl_push(&w->frames, &w->frame_count, &frame, sizeof frame);
    return true;
}

/* The scale of the scene, from its dynamic bodies at the start. */
static void measure(work *w)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int i = 0; i < w->scene->body_count; ++i) {
        const pl_body *body = &w->scene->bodies[i];
        if (body->is_static) {
            continue;
        }
        const double radius = pl_bounding_radius(&body->shape);
        w->moving += 1;
        w->radius = fmax(w->radius, radius);
        for (int k = 0; k < 3; ++k) {
            low[k] = fmin(low[k], body->position[k] - radius);
            high[k] = fmax(high[k], body->position[k] + radius);
        }
    }
    for (int k = 0; k < 3 && w->moving > 0; ++k) {
        w->size = hypot(w->size, high[k] - low[k]);
    }
    w->size = fmax(w->size, 1e-3);
    w->bound = w->size / 2000;
    w->position_unit = w->bound / 8;
    w->orientation_unit = fmin(fmax(w->bound / (16 * fmax(w->radius, 1e-9)), 1.0 / 32767), 0.01);
}

/* ---- Thinning ---- */

/* Whether the line between frames a and b is near enough to frame `between` for every body. */
static bool is_between(const work *w, const raw_frame *a, const raw_frame *b,
                       const raw_frame *between)
{
    const double part = (double)(between->step - a->step) / (double)(b->step - a->step);
    for (int i = 0; i < w->moving; ++i) {
        double away = 0, turned = 0, same = 0;
        for (int k = 3; k < 7; ++k) {
            same += (double)float_at(a->poses, 7L * i + k) * (double)float_at(b->poses, 7L * i + k);
        }
        for (int k = 0; k < 7; ++k) {
            const double from = (double)float_at(a->poses, 7L * i + k);
            const double to = (double)float_at(b->poses, 7L * i + k) * (k > 2 && same < 0 ? -1 : 1);
            const double off =
                from + part * (to - from) - (double)float_at(between->poses, 7L * i + k);
            const double other =
                from + part * (to - from) + (double)float_at(between->poses, 7L * i + k);
            if (k < 3) {
                away += off * off;
            } else {
                turned += fabs(off) < fabs(other) || same == 0 ? off * off : other * other;
            }
        }
        /* A rotation that differs by dq in its quaternion moves a point at r by at most 2 r |dq|. */
        if (sqrt(away) + 2 * w->radius * sqrt(turned) > w->bound / 2) {
            return false;
        }
    }
    return true;
}

static void thin(work *w)
{
    for (int from = 0; from < w->frame_count;) {
        int to = from + 1;
        pl_push(&w->kept, &w->kept_count, &from, sizeof from);
        for (bool holds = true; holds && to + 1 < w->frame_count && to + 1 - from <= LONGEST_GAP;) {
            for (int k = from + 1; k <= to && holds; ++k) {
                holds = is_between(w, &w->frames[from], &w->frames[to + 1], &w->frames[k]);
            }
            to += holds;
        }
        from = to;
    }
}

/* ---- Writing ---- */

/* Adds an integer: zig-zag, then seven bits a byte, the lowest first. */
static void add_integer(pl_text_buffer *bytes, int64_t value)
{
    uint64_t left = ((uint64_t)value << 1) ^ (uint64_t)(value >> 63);
    char coded[10];
    size_t length = 0;
    do {
        coded[length++] = (char)((left & 127) | (left > 127 ? 128 : 0));
        left >>= 7;
    } while (left > 0);
    pl_text_add_bytes(bytes, coded, length);
}

static int64_t rounded(double value, double unit)
{
    return isfinite(value) ? (int64_t)llround(value / unit) : 0;
}

/* Adds the integers so far as a JSON text, deflated and in base64 (RFC 4648), and removes them. */
static void add_packed(work *w)
{
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    uLongf length = compressBound(w->bytes.length);
    unsigned char *packed = pl_heap_new(1, length + 3);
    if (compress2(packed, &length, (const Bytef *)w->bytes.data, w->bytes.length, 9) != Z_OK) {
        pl_out_of_memory();
    }
    memset(packed + length, 0, 3);
    pl_text_add(&w->out, "\"");
    for (size_t i = 0; i < length; i += 3) {
        const unsigned three =
            (unsigned)packed[i] << 16 | (unsigned)packed[i + 1] << 8 | packed[i + 2];
        const char four[4] = {letters[three >> 18], letters[three >> 12 & 63],
                              i + 1 < length ? letters[three >> 6 & 63] : '=',
                              i + 2 < length ? letters[three & 63] : '='};
        pl_text_add_bytes(&w->out, four, 4);
    }
    pl_text_add(&w->out, "\"");
    free(packed);
    w->bytes.length = 0;
}

static void add_frames(work *w)
{
    pl_text_format(&w->out, "\"frames\":{\"step\":[");
    for (int f = 0; f < w->kept_count; ++f) {
        pl_text_format(&w->out, f == 0 ? "%lld" : ",%lld", (long long)w->frames[w->kept[f]].step);
    }
    pl_text_format(
        &w->out,
        "],\"position_unit\":%.6g,\"orientation_unit\":%.6g,\"error_bound\":%.6g,\"data\":",
        w->position_unit, w->orientation_unit, w->bound);
    for (int i = 0; i < w->moving; ++i) {
        for (int c = 0; c < 7; ++c) {
            int64_t last = 0;
            double turn = 1;
            for (int f = 0; f < w->kept_count; ++f) {
                const char *poses = w->frames[w->kept[f]].poses;
                if (f > 0 && c > 2) {
                    const char *before = w->frames[w->kept[f - 1]].poses;
                    double same = 0;
                    for (int k = 3; k < 7; ++k) {
                        same += (double)float_at(before, 7L * i + k) *
                                (double)float_at(poses, 7L * i + k);
                    }
                    turn = same < 0 ? -turn : turn;
                }
                const double value = (double)float_at(poses, 7L * i + c) * (c > 2 ? turn : 1);
                const int64_t now = rounded(value, c < 3 ? w->position_unit : w->orientation_unit);
                add_integer(&w->bytes, now - last);
                last = now;
            }
        }
    }
    add_packed(w);
    pl_text_add(&w->out, "}");
}

/* A contact of a frame by its depth. */
typedef struct deep {
    float depth;
    int index;
} deep;

static int compare_depths(const void *left, const void *right)
{
    const deep *a = left, *b = right;
    const int order = (b->depth > a->depth) - (b->depth < a->depth);
    return order != 0 ? order : (a->index > b->index) - (a->index < b->index);
}

/* The columns of the contacts of a frame, the deepest first. */
static void add_contact_columns(work *w, const raw_frame *frame, deep *order, double depth_unit,
                                double force_unit)
{
    const int all = frame->contact_count > 0 ? frame->contact_count : 0; /* -1 at the start */
    const int count = all < MOST_CONTACTS ? all : MOST_CONTACTS;
    for (int i = 0; i < all; ++i) {
        order[i] = (deep){float_at(frame->contacts, 5L * i + 3), i};
    }
    qsort(order, (size_t)all, sizeof *order, compare_depths);
    add_integer(&w->bytes, count);
    for (int column = 0; column < 5; ++column) {
        const double unit = column < 3 ? w->position_unit : column == 3 ? depth_unit : force_unit;
        int64_t last = 0;
        for (int i = 0; i < count; ++i) {
            const double value = (double)float_at(frame->contacts, 5L * order[i].index + column);
            const int64_t now = unit > 0 ? rounded(value, unit) : 0;
            add_integer(&w->bytes, column < 3 ? now - last : now);
            last = now;
        }
    }
}

/* Depths are given to a ten-thousandth of the largest body, forces to a quarter of the mean weight. */
static void add_contacts(work *w)
{
    const int frames = w->kept_count < MOST_CONTACT_FRAMES ? w->kept_count : MOST_CONTACT_FRAMES;
    const double depth_unit = fmax(w->radius, 1e-6) * 1e-4;
    double weight = 0;
    int most = 0;
    for (int i = 0; i < w->scene->body_count; ++i) {
        const pl_body *body = &w->scene->bodies[i];
        weight += body->is_static ? 0 : body->mass * pl_vec_length(pl_vec_of(w->scene->gravity));
    }
    for (int f = 0; f < w->kept_count; ++f) {
        const int count = w->frames[w->kept[f]].contact_count;
        most = count > most ? count : most;
    }
    const double force_unit = weight / (4 * fmax(w->moving, 1));
    if (w->frames[w->kept[w->kept_count - 1]].contact_count < 0) {
        pl_text_add(&w->out, "\"contacts\":null");
        return;
    }
    deep *order = pl_heap_new((size_t)most, sizeof *order);
    pl_text_add(&w->out, "\"contacts\":{\"frame\":[");
    for (int f = 0; f < frames; ++f) {
        const int index = frames == 1 ? 0 : (int)((long)f * (w->kept_count - 1) / (frames - 1));
        const raw_frame *frame = &w->frames[w->kept[index]];
        pl_text_format(&w->out, f == 0 ? "%d" : ",%d", index);
        add_contact_columns(w, frame, order, depth_unit, force_unit);
    }
    pl_text_format(&w->out, "],\"depth_unit\":%.6g,\"force_unit\":", depth_unit);
    pl_text_format(&w->out, force_unit > 0 ? "%.6g" : "null", force_unit);
    pl_text_add(&w->out, ",\"data\":");
    add_packed(w);
    pl_text_add(&w->out, "}");
    free(order);
}

static void add_curves(work *w)
{
    pl_text_add(&w->out, "\"curves\":{\"step\":[");
    for (int i = 0; i < w->curve_count; ++i) {
        pl_text_format(&w->out, i == 0 ? "%lld" : ",%lld", (long long)w->curves[i].step);
    }
    pl_text_add(&w->out, "]");
    for (int k = 0; k < PL_CURVE_COUNT; ++k) {
        bool has_value = false;
        for (int i = 0; i < w->curve_count; ++i) {
            has_value |= isfinite(w->curves[i].value[k]);
        }
        if (!has_value) {
            continue;
        }
        pl_text_format(&w->out, ",\"%s\":[", pl_curve_name((pl_curve)k));
        for (int i = 0; i < w->curve_count; ++i) {
            const bool finite = isfinite(w->curves[i].value[k]);
            pl_text_add(&w->out, i == 0 ? "" : ",");
            pl_text_format(&w->out, finite ? "%.4g" : "null", w->curves[i].value[k]);
        }
        pl_text_add(&w->out, "]");
    }
    pl_text_add(&w->out, "}");
}

static void add_recording(work *w)
{
    pl_text_format(&w->out,
                   "{\"schema\":\"plumb.recording/"
                   "1\",\"run\":\"%s\",\"bodies\":%d,\"dt\":%.17g,\"steps\":%lld,\"moving\":[",
                   w->run, w->scene->body_count, w->scene->dt,
                   (long long)w->frames[w->kept[w->kept_count - 1]].step);
    for (int i = 0, first = 1; i < w->scene->body_count; ++i) {
        if (!w->scene->bodies[i].is_static) {
            pl_text_format(&w->out, first ? "%d" : ",%d", i);
            first = 0;
        }
    }
    pl_text_add(&w->out, "],");
    add_frames(w);
    pl_text_add(&w->out, ",");
    add_contacts(w);
    pl_text_add(&w->out, ",");
    add_curves(w);
    pl_text_add(&w->out, "}\n");
}

static pl_status compact(work *w, const char *text, size_t length, const char *path,
                         pl_error *error)
{
    const char *at = text + 8, *end = text + length;
    if (length < 8 || memcmp(text, PL_RAW_MAGIC, 8) != 0) {
        return PL_OK;
    }
    measure(w);
    while (read_record(w, &at, end)) {}
    if (w->frame_count == 0) {
        return PL_OK;
    }
    thin(w);
    add_recording(w);
    if (w->bytes.failed) {
        pl_out_of_memory();
    }
    return pl_write_buffer(path, &w->out, error);
}

pl_status pl_recording_finish(const char *folder, const char *run, const pl_scene *scene,
                              pl_error *error)
{
    static const pl_file_kind kind = {.noun = "recording", .most_bytes = (size_t)1 << 31};
    work w = {.scene = scene, .run = run};
    char *raw = pl_run_file(folder, run, "raw"), *path = pl_run_file(folder, run, "json");
    char *text = NULL;
    size_t length = 0;
    pl_status status = access(raw, F_OK) != 0 ? PL_OK /* it ended before its first frame */
                                              : pl_file_read(&kind, raw, &text, &length, error);
    if (status == PL_OK && text != NULL) {
        status = compact(&w, text, length, path, error);
    }
    unlink(raw);
    free(raw);
    free(path);
    free(text);
    free(w.frames);
    free(w.kept);
    free(w.curves);
    pl_text_free(&w.bytes);
    pl_text_free(&w.out);
    return status;
}
