/* Files that a scene names: only plain files below its folder or an allowed one are opened. */
#include "base/file_beneath.h"
#include "check.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[256]; /* holds scene/, files beside it, and symbolic links */

static const char *in_folder(const char *name)
{
    static char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void write_file(const char *name)
{
    FILE *file = fopen(in_folder(name), "w");
    assert_non_null(file);
    assert_int_equal(fclose(file), 0);
}

static int make_folder(void **state)
{
    (void)state;
    char target[512];
    snprintf(folder, sizeof folder, "%s/beneath_XXXXXX", PLUMB_BINARY_DIR);
    assert_non_null(mkdtemp(folder));
    assert_int_equal(mkdir(in_folder("scene"), 0700), 0);
    assert_int_equal(mkdir(in_folder("scene/sub"), 0700), 0);
    assert_int_equal(mkdir(in_folder("scene2"), 0700), 0);
    write_file("scene/in.obj");
    write_file("scene/sub/in.obj");
    write_file("scene2/out.obj");
    write_file("out.obj");
    snprintf(target, sizeof target, "%s", in_folder("out.obj"));
    assert_int_equal(symlink("../out.obj", in_folder("scene/leads_out")), 0);
    assert_int_equal(symlink(target, in_folder("scene/leads_away")), 0);
    assert_int_equal(symlink("sub/in.obj", in_folder("scene/leads_in")), 0);
    assert_int_equal(symlink("..", in_folder("scene/parent")), 0);
    assert_int_equal(symlink("loop", in_folder("scene/loop")), 0);
    assert_int_equal(mkfifo(in_folder("scene/fifo"), 0600), 0);
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[512];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

/* Opens a path from the folder scene/. */
static pl_status open_named(const char *path, pl_error *error)
{
    char scene[512];
    int descriptor = -1;
    snprintf(scene, sizeof scene, "%s", in_folder("scene/"));
    const pl_status status = pl_file_open_beneath("test", scene, path, path, &descriptor, error);
    if (status == PL_OK) {
        assert_int_equal(close(descriptor), 0);
    }
    return status;
}

static void expect_refused(const char *path, const char *found)
{
    pl_error error = {.message = ""};
    assert_int_equal(open_named(path, &error), PL_BAD_INPUT);
    assert_contains(error.message, "expected a test file");
    assert_contains(error.message, found);
}

static const char *const inside[] = {"in.obj", "sub/in.obj", "sub/../in.obj", "leads_in",
                                     "./in.obj"};
static const char *const outside[] = {"../out.obj", "../scene2/out.obj", "leads_out",
                                      "leads_away", "parent/out.obj",    "sub/../../out.obj"};

static void test_files_below_the_folder_are_opened(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof inside / sizeof inside[0]; ++i) {
        pl_error error = {.message = ""};
        if (open_named(inside[i], &error) != PL_OK) {
            fail_msg("%s", error.message);
        }
    }
    char path[512];
    snprintf(path, sizeof path, "%s", in_folder("scene/in.obj"));
    assert_int_equal(open_named(path, NULL), PL_OK);
}

static void test_files_elsewhere_are_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; ++i) {
        expect_refused(outside[i], "found one elsewhere; --allow-files DIR");
    }
    char path[512];
    snprintf(path, sizeof path, "%s", in_folder("scene2/out.obj"));
    expect_refused(path, "found one elsewhere");
    expect_refused("/etc/passwd", "found one elsewhere");
    expect_refused("/dev/zero", "found one elsewhere");
}

/* Nothing here waits: a FIFO has no writer. */
static void test_only_plain_files_are_opened(void **state)
{
    (void)state;
    expect_refused("fifo", "found a FIFO");
    expect_refused("sub", "found a directory");
    expect_refused("none", "found none to read");
    expect_refused("loop", "found");
}

static void test_allowed_folders_are_opened_too(void **state)
{
    (void)state;
    char paths[1024], path[512];
    snprintf(paths, sizeof paths, "/nowhere:%s/scene2", folder);
    assert_int_equal(setenv(PL_ALLOWED_VARIABLE, paths, 1), 0);
    assert_int_equal(open_named("../scene2/out.obj", NULL), PL_OK);
    snprintf(path, sizeof path, "%s", in_folder("scene2/out.obj"));
    assert_int_equal(open_named(path, NULL), PL_OK);
    expect_refused("../out.obj", "found one elsewhere");
    assert_int_equal(setenv(PL_ALLOWED_VARIABLE, "/dev:/proc", 1), 0);
    expect_refused("/dev/zero", "found a device");
    expect_refused(path, "found one elsewhere");
    assert_int_equal(unsetenv(PL_ALLOWED_VARIABLE), 0);
}

static void test_old_kernels_open_the_same_files(void **state)
{
    (void)state;
    char scene[512];
    snprintf(scene, sizeof scene, "%s", in_folder("scene/"));
    for (size_t i = 0; i < sizeof inside / sizeof inside[0]; ++i) {
        const int descriptor = pl_open_by_real_name(scene, inside[i]);
        assert_true(descriptor >= 0);
        assert_int_equal(close(descriptor), 0);
    }
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; ++i) {
        assert_int_equal(pl_open_by_real_name(scene, outside[i]), -1);
        assert_int_equal(errno, EXDEV);
    }
    const int fifo = pl_open_by_real_name(scene, "fifo");
    assert_true(fifo >= 0);
    assert_int_equal(close(fifo), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_files_below_the_folder_are_opened),
        cmocka_unit_test(test_files_elsewhere_are_refused),
        cmocka_unit_test(test_only_plain_files_are_opened),
        cmocka_unit_test(test_allowed_folders_are_opened_too),
        cmocka_unit_test(test_old_kernels_open_the_same_files),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
