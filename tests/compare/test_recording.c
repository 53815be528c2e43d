/* Recordings: what they say against the trajectory of the same run, and that they change nothing. */
#include "check.h"
#include "plumb/vec.h"
#include "plumb_process.h"
#include "runner/recording.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { MOST_BODIES = 128, MOST_FRAMES = 700 };

/* A whole trajectory: poses of all bodies in every frame. */
typedef struct path {
    int bodies, frames;
    double pose[MOST_FRAMES][MOST_BODIES][7];
} path;

static int letter_of(char c)
{
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *found = strchr(letters, c);
    return c == '=' || found == NULL ? 0 : (int)(found - letters);
}

/* The bytes of a packed text; the caller frees. */
static unsigned char *unpack(const char *text, uLongf *length)
{
    const size_t letters = strlen(text);
    unsigned char *packed = calloc(letters + 3, 1), *plain = NULL;
    for (size_t i = 0; i + 3 < letters; i += 4) {
        const unsigned three =
            (unsigned)letter_of(text[i]) << 18 | (unsigned)letter_of(text[i + 1]) << 12 |
            (unsigned)letter_of(text[i + 2]) << 6 | (unsigned)letter_of(text[i + 3]);
        packed[i / 4 * 3] = (unsigned char)(three >> 16);
        packed[i / 4 * 3 + 1] = (unsigned char)(three >> 8);
        packed[i / 4 * 3 + 2] = (unsigned char)three;
    }
    *length = 64 << 20;
    plain = malloc(*length);
    assert_int_equal(uncompress(plain, length, packed, letters / 4 * 3), Z_OK);
    free(packed);
    return plain;
}

static int64_t next_integer(const unsigned char **at)
{
    uint64_t value = 0;
    int shift = 0;
    do {
        value |= (uint64_t)(**at & 127) << shift;
        shift += 7;
    } while ((*(*at)++ & 128) != 0);
    return (int64_t)(value >> 1) ^ -(int64_t)(value & 1);
}

static double number_of(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    assert_true(json_is_number(value));
    return json_number_value(value);
}

/* The only recording of a folder; the caller releases it. */
static json_t *recording_of(const char *directory)
{
    char command[512], name[600];
    snprintf(command, sizeof command, "ls %s/results/recordings/", directory);
    FILE *listing = popen(command, "r");
    char file[64] = "", second[64] = "";
    assert_int_equal(fscanf(listing, "%63s %63s", file, second), 1);
    pclose(listing);
    snprintf(name, sizeof name, "%s/results/recordings/%s", directory, file);
    json_t *recording = json_load_file(name, 0, NULL);
    assert_non_null(recording);
    assert_string_equal(json_string_value(json_object_get(recording, "schema")),
                        "plumb.recording/1");
    return recording;
}

/* Runs a case on an engine with a recording, and again with a trajectory. */
static json_t *record(const char *directory, const char *const *words, path *whole)
{
    const char *compare[16] = {"compare"}, *run[16] = {"run"};
    int count = 1;
    for (; words[count - 1] != NULL; ++count) {
        compare[count] = run[count] = words[count - 1];
    }
    char *out = path_in(directory, "results"), *csv = path_in(directory, "path.csv");
    compare[count] = "--out";
    compare[count + 1] = out;
    run[count] = "--trajectory";
    run[count + 1] = csv;
    plumb_output first = run_plumb(directory, compare), second = run_plumb(directory, run);
    assert_int_equal(first.code, 0);
    free_output(&first);
    free_output(&second);
    char line[1024];
    FILE *file = fopen(csv, "r");
    assert_non_null(file);
    assert_non_null(fgets(line, sizeof line, file));
    double time = -1, last = -1;
    *whole = (path){.frames = 0};
    for (int body = 0; fgets(line, sizeof line, file) != NULL; ++body) {
        assert_int_equal(sscanf(line, "%lf", &time), 1);
        if (time != last) {
            whole->frames += 1;
            body = 0;
            last = time;
        }
        assert_true(whole->frames <= MOST_FRAMES && body < MOST_BODIES);
        double *q = whole->pose[whole->frames - 1][body];
        assert_int_equal(sscanf(strrchr(line, '"') + 2, "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &q[0], &q[1],
                                &q[2], &q[3], &q[4], &q[5], &q[6]),
                         7);
        whole->bodies = body + 1 > whole->bodies ? body + 1 : whole->bodies;
    }
    fclose(file);
    free(out);
    free(csv);
    return recording_of(directory);
}

/* The largest distance of a point at `radius` of a body between the recording and the trajectory. */
static double largest_error(const json_t *recording, const path *whole, double radius)
{
    const json_t *frames = json_object_get(recording, "frames"),
                 *steps = json_object_get(frames, "step"),
                 *moving = json_object_get(recording, "moving");
    const double unit[2] = {number_of(frames, "position_unit"),
                            number_of(frames, "orientation_unit")};
    const int count = (int)json_array_size(steps), bodies = (int)json_array_size(moving);
    uLongf length;
    unsigned char *plain = unpack(json_string_value(json_object_get(frames, "data")), &length);
    const unsigned char *at = plain;
    double(*pose)[MOST_BODIES][7] = calloc((size_t)count, sizeof *pose), worst = 0;
    for (int b = 0; b < bodies; ++b) {
        for (int c = 0; c < 7; ++c) {
            int64_t sum = 0;
            for (int f = 0; f < count; ++f) {
                sum += next_integer(&at);
                pose[f][b][c] = (double)sum * unit[c > 2];
            }
        }
    }
    assert_int_equal(at - plain, length);
    for (int step = 0, f = 0; step < whole->frames; ++step) {
        while (f + 2 < count && json_integer_value(json_array_get(steps, (size_t)f + 1)) < step) {
            ++f;
        }
        const double from = (double)json_integer_value(json_array_get(steps, (size_t)f)),
                     to = (double)json_integer_value(json_array_get(steps, (size_t)f + 1)),
                     part = ((double)step - from) / (to - from);
        for (int b = 0; b < bodies; ++b) {
            const double *right =
                whole->pose[step][json_integer_value(json_array_get(moving, (size_t)b))];
            double away = 0, same = 0, turned = 0;
            for (int c = 0; c < 7; ++c) {
                same += c > 2 ? right[c] * pose[f][b][c] : 0;
            }
            for (int c = 0; c < 7; ++c) {
                const double value = pose[f][b][c] + part * (pose[f + 1][b][c] - pose[f][b][c]);
                const double off = value - right[c] * (c > 2 && same < 0 ? -1 : 1);
                *(c < 3 ? &away : &turned) += off * off;
            }
            worst = fmax(worst, sqrt(away) + 2 * radius * sqrt(turned));
        }
    }
    free(pose);
    free(plain);
    return worst;
}

static void test_drawn_points_keep_to_the_error_bound(void **state)
{
    (void)state;
    static const char *const cases[][8] = {
        {"tower", "--set", "n=3,duration=2", "--engine", "plumb", NULL},
        {"falling-cubes", "--set", "duration=2", "--engine", "ode:quick", NULL},
        {"rocket", "--set", "duration=2", "--engine", "bullet:si", NULL}};
    path *whole = malloc(sizeof *whole);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char *directory = make_directory();
        json_t *recording = record(directory, cases[i], whole);
        const json_t *frames = json_object_get(recording, "frames");
        const double bound = number_of(frames, "error_bound");
        assert_true(bound > 0 && bound < 0.05);
        assert_at_most(largest_error(recording, whole, 0.5), bound);
        assert_int_equal(json_integer_value(json_object_get(recording, "steps")),
                         whole->frames - 1);
        json_decref(recording);
        remove_directory(directory);
    }
    free(whole);
}

static void test_bodies_at_rest_keep_few_frames(void **state)
{
    (void)state;
    static const char *const words[] = {"tower", "--set", "n=3", "--engine", "plumb", NULL};
    char *directory = make_directory();
    path *whole = malloc(sizeof *whole);
    json_t *recording = record(directory, words, whole);
    const json_t *steps = json_object_get(json_object_get(recording, "frames"), "step");
    assert_true(json_array_size(steps) < 20 && whole->frames == 601);
    json_decref(recording);
    free(whole);
    remove_directory(directory);
}

static void test_contacts_and_curves_of_a_resting_tower(void **state)
{
    (void)state;
    static const char *const words[] = {"tower",    "--set", "n=1,duration=1",
                                        "--engine", "plumb", NULL};
    char *directory = make_directory();
    path *whole = malloc(sizeof *whole);
    json_t *recording = record(directory, words, whole);
    const json_t *contacts = json_object_get(recording, "contacts");
    const json_t *curves = json_object_get(recording, "curves");
    uLongf length;
    unsigned char *plain = unpack(json_string_value(json_object_get(contacts, "data")), &length);
    const unsigned char *at = plain;
    assert_int_equal(next_integer(&at), 0); /* none at the start */
    assert_int_equal(next_integer(&at), 4); /* a cube on the ground */
    free(plain);
    const json_t *force = json_object_get(curves, "contact_force");
    const size_t last = json_array_size(force) - 1;
    assert_close(json_number_value(json_array_get(force, last)), 9.81, 0, 1e-3);
    assert_true(json_is_null(json_array_get(force, 0)));
    assert_at_most(json_number_value(json_array_get(json_object_get(curves, "rest_error"), last)),
                   1e-6);
    assert_at_most(
        json_number_value(json_array_get(json_object_get(curves, "kinetic_energy"), last)), 1e-9);
    json_decref(recording);
    free(whole);
    remove_directory(directory);
}

static void test_energy_of_free_fall_stays(void **state)
{
    (void)state;
    static const char *const words[] = {"free-fall", "--set", "duration=0.5",
                                        "--engine",  "plumb", NULL};
    char *directory = make_directory();
    path *whole = malloc(sizeof *whole);
    json_t *recording = record(directory, words, whole);
    const json_t *curves = json_object_get(recording, "curves");
    const json_t *kinetic = json_object_get(curves, "kinetic_energy"),
                 *energy = json_object_get(curves, "energy");
    const size_t last = json_array_size(energy) - 1;
    const double gained = json_number_value(json_array_get(kinetic, last)) -
                          json_number_value(json_array_get(kinetic, 0));
    assert_true(fabs(gained) > 1);
    assert_close(json_number_value(json_array_get(energy, last)),
                 json_number_value(json_array_get(energy, 0)), 1e-3 * fabs(gained), 0);
    json_decref(recording);
    free(whole);
    remove_directory(directory);
}

static void test_recordings_change_no_result(void **state)
{
    (void)state;
    static const char *const names[] = {"state_hash", "reference_error", "penetration_max",
                                        "energy_gain"};
    char *directory = make_directory(), *recordings[2];
    json_t *rows[2];
    for (int i = 0; i < 2; ++i) {
        char *out = path_in(directory, i == 0 ? "with" : "without"),
             *file = path_in(out, "results.jsonl");
        const char *const words[] = {"compare",
                                     "falling-cubes",
                                     "--engine",
                                     "plumb",
                                     "--out",
                                     out,
                                     i == 0 ? NULL : "--no-recordings",
                                     NULL};
        plumb_output output = run_plumb(directory, words);
        rows[i] = json_load_file(file, 0, NULL);
        recordings[i] = path_in(out, "recordings");
        assert_non_null(rows[i]);
        free_output(&output);
        free(out);
        free(file);
    }
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        const json_t *x = json_object_get(json_object_get(rows[0], "metrics"), names[i]);
        const json_t *y = json_object_get(json_object_get(rows[1], "metrics"), names[i]);
        assert_true(x != NULL && json_equal(x, y));
    }
    assert_int_equal(access(recordings[0], F_OK), 0);
    assert_int_not_equal(access(recordings[1], F_OK), 0);
    for (int i = 0; i < 2; ++i) {
        free(recordings[i]);
        json_decref(rows[i]);
    }
    remove_directory(directory);
}

static void test_crashed_run_keeps_its_steps_alone(void **state)
{
    (void)state;
    workspace w = make_workspace();
    const char *const words[] = {"compare",        w.scene, "--engine", FAULTY ":segfault",
                                 "--no-reference", "--out", w.out,      NULL};
    plumb_output output = run_plumb(w.directory, words);
    char command[600];
    int raw = -1, whole = -1;
    snprintf(command, sizeof command,
             "ls %s/recordings/*.raw 2>/dev/null | wc -l; ls %s/recordings/*.json | wc -l", w.out,
             w.out);
    FILE *listing = popen(command, "r");
    assert_int_equal(fscanf(listing, "%d %d", &raw, &whole), 2);
    pclose(listing);
    assert_int_equal(raw, 0);
    assert_int_equal(whole, 1);
    free_output(&output);
    remove_workspace(&w);
}

static void test_removing_recordings_leaves_other_files(void **state)
{
    (void)state;
    static const char *const names[] = {"0123456789abcdef.json", "0123456789abcdef.raw",
                                        "mine.json", "0123456789abcdef.txt"};
    char *directory = make_directory(), name[512];
    for (int i = 0; i < 4; ++i) {
        snprintf(name, sizeof name, "%s/%s", directory, names[i]);
        fclose(fopen(name, "w"));
    }
    pl_recordings_remove(directory, NULL);
    for (int i = 0; i < 4; ++i) {
        snprintf(name, sizeof name, "%s/%s", directory, names[i]);
        assert_int_equal(access(name, F_OK) == 0, i > 1);
    }
    remove_directory(directory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_drawn_points_keep_to_the_error_bound),
        cmocka_unit_test(test_bodies_at_rest_keep_few_frames),
        cmocka_unit_test(test_contacts_and_curves_of_a_resting_tower),
        cmocka_unit_test(test_energy_of_free_fall_stays),
        cmocka_unit_test(test_recordings_change_no_result),
        cmocka_unit_test(test_crashed_run_keeps_its_steps_alone),
        cmocka_unit_test(test_removing_recordings_leaves_other_files),
    };
    return cmocka_run_group_tests_name("recording", tests, NULL, NULL);
}
