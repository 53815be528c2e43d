/* SPEC parsing, labels, and the loading of shared objects, which this test compiles for itself. */
#include "engines/registry.h"

#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char template_source[] =
    "#include \"plumb/engine_abi.h\"\n"
    "#ifndef VERSION\n#define VERSION PL_ENGINE_ABI_VERSION\n#endif\n"
    "#ifndef SIZE\n#define SIZE sizeof(pl_engine)\n#endif\n"
    "#ifndef PROFILES\n#define PROFILES 2\n#endif\n"
    "#ifndef OPTIONS\n#define OPTIONS 2\n#endif\n"
    "#ifndef STEP\n#define STEP step\n#endif\n"
    "#ifndef ENGINE_NAME\n#define ENGINE_NAME \"mine\"\n#endif\n"
    "#ifndef PROFILE_NAME\n#define PROFILE_NAME \"fast\"\n#endif\n"
    "#ifndef OPTION_NAME\n#define OPTION_NAME \"iterations\"\n#endif\n"
    "#ifndef ITERATIONS\n#define ITERATIONS 4\n#endif\n"
    "#ifndef STIFFNESS\n#define STIFFNESS 0.75\n#endif\n"
    "#ifndef TUNE\n#define TUNE\n#endif\n"
    "#ifndef MORE\n#define MORE\n#endif\n"
    "static pl_status create(const pl_engine_setup *s, pl_engine_instance **i, pl_error *e)\n"
    "    { (void)s; (void)i; (void)e; return PL_UNSUPPORTED; }\n"
    "static void destroy(pl_engine_instance *i) { (void)i; }\n"
    "static inline pl_status step(pl_engine_instance *i, double d, pl_step_stats *s, pl_error *e)\n"
    "    { (void)i; (void)d; (void)s; (void)e; return PL_FAILED; }\n"
    "static void frame(const pl_engine_instance *i, pl_frame *f) { (void)i; (void)f; }\n"
    "static void defaults(int profile, double *v) { if (profile == 1) v[1] = STIFFNESS; }\n"
    "static const pl_engine_profile profiles[] = {{.name = PROFILE_NAME}, {.name = \"slow\"}};\n"
    "static const pl_engine_option options[] = {\n"
    "    {.name = OPTION_NAME, .value = ITERATIONS, .min = 1, .max = 100, .integer = true, TUNE},\n"
    "    {.name = \"stiffness\", .value = 0.25, .min = 0, .max = 1}};\n"
    "static const pl_engine engine = {.struct_size = SIZE, .abi_version = VERSION,\n"
    "    .name = ENGINE_NAME,\n"
    "    .version = \"1\", .description = \"\", .substeps = 1, .profiles = profiles, "
    ".profile_count = PROFILES, .options = options,\n"
    "    .option_count = OPTIONS, .profile_defaults = defaults, .create = create,\n"
    "    .destroy = destroy, .step = STEP, .read_frame = frame MORE};\n"
    "#ifndef NAME\n#define NAME plumb_engine\n#endif\n"
    "#ifndef RESULT\n#define RESULT &engine\n#endif\n"
    "const pl_engine *NAME(void);\n"
    "const pl_engine *NAME(void) { (void)engine.name; return RESULT; }\n";

static char folder[64];

/* Compiles the template with `flags` into folder/name. */
static void build_object(const char *name, const char *flags)
{
    char command[1024];
    const char *compiler = getenv("CC") != NULL ? getenv("CC") : "cc";
    snprintf(command, sizeof command,
             "%s -std=c17 -w -shared -fPIC -I%s/compare/include -I%s/scenarios/include %s -o %s/%s "
             "-x c %s/template.c",
             compiler, PLUMB_SOURCE_DIR, PLUMB_SOURCE_DIR, flags, folder, name, folder);
    assert_int_equal(system(command), 0);
}

static int make_objects(void **state)
{
    (void)state;
    char path[128];
    snprintf(folder, sizeof folder, "/tmp/plumb-registry-XXXXXX");
    if (mkdtemp(folder) == NULL) {
        return -1;
    }
    snprintf(path, sizeof path, "%s/template.c", folder);
    FILE *file = fopen(path, "w");
    if (file == NULL || fputs(template_source, file) < 0 || fclose(file) != 0) {
        return -1;
    }
    build_object("mine.so", "");
    build_object("a,b:c.so", "");
    return 0;
}

static int remove_objects(void **state)
{
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

static pl_engine_choice choose(const char *spec)
{
    pl_engine_choice choice = {.engine = NULL};
    pl_error error = {.message = ""};
    pl_status status = pl_engine_choose(spec, &choice, &error);
    if (status != PL_OK) {
        print_error("%s: %s\n", spec, error.message);
    }
    assert_int_equal(status, PL_OK);
    return choice;
}

/* The spec fails with this status, and its message holds both parts. The choice stays as it was. */
static void assert_refused(const char *spec, pl_status expected, const char *part, const char *more)
{
    pl_engine_choice choice = {.profile = 77};
    pl_error error = {.message = ""};
    pl_status status = pl_engine_choose(spec, &choice, &error);
    if (status != expected) {
        print_error("%s: status %d, message \"%s\"\n", spec, (int)status, error.message);
    }
    assert_int_equal(status, expected);
    assert_int_equal(error.status, expected);
    assert_contains(error.message, part);
    assert_contains(error.message, more);
    assert_int_equal(choice.profile, 77);
    assert_int_equal(pl_engine_choose(spec, &choice, NULL), expected);
}

static void in_folder(const char *rest, char spec[256])
{
    snprintf(spec, 256, "%s/%s", folder, rest);
}

static void test_engines_are_listed_with_plumb_first(void **state)
{
    (void)state;
    int count = 0;
    const pl_built_in *known = pl_built_in_engines(&count);
    assert_string_equal(known[0].name, "plumb");
    for (int i = 0; i < count; ++i) {
        assert_non_null(known[i].package);
        if (known[i].entry != NULL) {
            const pl_engine_info *info = NULL;
            assert_int_equal(pl_engine_of_build(&known[i], &info, NULL), PL_OK);
            assert_string_equal(info->name, known[i].name);
        } else if (!pl_built_in_is_present(&known[i])) {
            assert_refused(known[i].name, PL_UNSUPPORTED, known[i].name, known[i].package);
        }
    }
}

static void test_bare_engine_name_is_its_first_profile(void **state)
{
    (void)state;
    int count = 0;
    const pl_built_in *known = pl_built_in_engines(&count);
    for (int i = 0; i < count; ++i) {
        if (known[i].entry == NULL) {
            continue;
        }
        char label[PL_LABEL_SIZE], expected[PL_LABEL_SIZE];
        pl_engine_choice choice = choose(known[i].name);
        assert_ptr_equal(choice.engine->built_in, &known[i]);
        assert_int_equal(choice.profile, 0);
        assert_string_equal(choice.spec, known[i].name);
        pl_engine_choice_label(&choice, label);
        snprintf(expected, sizeof expected, "%s:%s", known[i].name,
                 choice.engine->profiles[0].name);
        assert_string_equal(label, expected);
    }
}

static void test_profile_defaults_come_before_the_users_options(void **state)
{
    (void)state;
    char spec[256], label[PL_LABEL_SIZE];
    in_folder("mine.so", spec);
    pl_engine_choice choice = choose(spec);
    assert_string_equal(choice.engine->name, "mine");
    assert_close(choice.values[0], 4, 0, 0);
    assert_close(choice.values[1], 0.25, 0, 0);

    in_folder("mine.so:slow", spec);
    choice = choose(spec);
    assert_int_equal(choice.profile, 1);
    assert_close(choice.values[1], 0.75, 0, 0);
    pl_engine_choice_label(&choice, label);
    assert_string_equal(label, "mine:slow");

    in_folder("mine.so:slow,stiffness=0.25,iterations=7", spec);
    choice = choose(spec);
    assert_close(choice.values[0], 7, 0, 0);
    assert_close(choice.values[1], 0.25, 0, 0);
    pl_engine_choice_label(&choice, label);
    assert_string_equal(label, "mine:slow,iterations=7,stiffness=0.25");

    in_folder("mine.so,iterations=100", spec);
    choice = choose(spec);
    assert_int_equal(choice.profile, 0);
    assert_close(choice.values[0], 100, 0, 0);
}

static void test_labels_distinguish_numbers_by_the_last_bit(void **state)
{
    (void)state;
    char spec[256], label[PL_LABEL_SIZE];
    in_folder("mine.so,stiffness=0.1", spec);
    pl_engine_choice choice = choose(spec);
    pl_engine_choice_label(&choice, label);
    assert_string_equal(label, "mine:fast,stiffness=0.1");
    choice.values[1] = nextafter(0.1, 1);
    pl_engine_choice_label(&choice, label);
    assert_string_equal(label, "mine:fast,stiffness=0.10000000000000002");
}

static void test_path_may_contain_colon_and_comma(void **state)
{
    (void)state;
    char spec[256], before[1024];
    in_folder("a,b:c.so:slow,iterations=9", spec);
    pl_engine_choice choice = choose(spec);
    assert_int_equal(choice.profile, 1);
    assert_close(choice.values[0], 9, 0, 0);

    assert_non_null(getcwd(before, sizeof before));
    assert_int_equal(chdir(folder), 0);
    choice = choose("mine.so:slow");
    assert_int_equal(choice.profile, 1);
    assert_int_equal(chdir(before), 0);
}

static void test_misspelt_names_get_the_nearest_suggested(void **state)
{
    (void)state;
    char spec[256];
    assert_refused("plum", PL_BAD_INPUT, "unknown engine \"plum\"", "did you mean \"plumb\"");
    assert_refused("bulet:si", PL_BAD_INPUT, "unknown engine", "\"bullet\"");
    assert_refused("xyzzyxyzzy", PL_BAD_INPUT, "unknown engine", "plumb, ode, bullet");
    in_folder("mine.so:fsat", spec);
    assert_refused(spec, PL_BAD_INPUT, "profile of engine mine", "did you mean \"fast\"");
    in_folder("mine.so:frobnicate", spec);
    assert_refused(spec, PL_BAD_INPUT, "unknown profile", "fast, slow");
    in_folder("mine.so,iteration=3", spec);
    assert_refused(spec, PL_BAD_INPUT, "option of engine mine", "did you mean \"iterations\"");
}

static void test_bad_options_are_refused_with_what_was_found(void **state)
{
    (void)state;
    static const struct {
        const char *rest, *part, *more;
    } cases[] = {
        {"mine.so,iterations=0", "iterations", "expected 1 to 100, found 0"},
        {"mine.so,iterations=101", "iterations", "found 101"},
        {"mine.so,iterations=2.5", "expected an integer", "2.5"},
        {"mine.so,iterations=", "expected a number", "\"\""},
        {"mine.so,iterations=ten", "expected a number", "\"ten\""},
        {"mine.so,iterations=7x", "expected a number", "\"7x\""},
        {"mine.so,stiffness=nan", "expected a number", "nan"},
        {"mine.so,stiffness=inf", "expected a number", "inf"},
        {"mine.so,stiffness=-1e-300", "expected 0 to 1", "-1e-300"},
        {"mine.so,iterations=7,iterations=7", "iterations", "twice"},
        {"mine.so,iterations", "\"iterations\"", "option=value"},
        {"mine.so,", "\"\"", "option=value"},
        {"mine.so,iterations=7,", "\"\"", "option=value"},
        {"mine.so:", "unknown profile", "\"\""},
        {"mine.so:fast:slow", "unknown profile", "\"fast:slow\""},
        {"mine.so,=7", "unknown option", "\"\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char spec[256];
        in_folder(cases[i].rest, spec);
        assert_refused(spec, PL_BAD_INPUT, cases[i].part, cases[i].more);
    }
    assert_refused("", PL_BAD_INPUT, "unknown engine", "\"\"");
    assert_refused(":fast", PL_BAD_INPUT, "unknown engine", "\"\"");
}

static void test_a_spec_longer_than_its_field_is_refused(void **state)
{
    (void)state;
    char spec[PL_SPEC_SIZE + 1];
    memset(spec, 'a', sizeof spec - 1);
    spec[PL_SPEC_SIZE] = '\0';
    assert_refused(spec, PL_BAD_INPUT, "longer than 1023", "aaaa");
    spec[PL_SPEC_SIZE - 1] = '\0';
    assert_refused(spec, PL_BAD_INPUT, "unknown engine", "aaaa");
}

static void test_shared_objects_of_another_abi_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *name, *flags, *part;
    } cases[] = {
        {"version.so", "-DVERSION=99", "engine ABI 99"},
        {"size.so", "-DSIZE=8", "pl_engine has 8 bytes"},
        {"symbol.so", "-DNAME=other_engine", "exports no plumb_engine"},
        {"null.so", "-DRESULT=0", "returned no engine"},
        {"profiles.so", "-DPROFILES=0", "profile_count: expected 1 to 64, found 0"},
        {"options.so", "-DOPTIONS=25", "option_count: expected 0 to 24, found 25"},
        {"step.so", "-DSTEP=0", "lacks step"},
        {"short.so", "-DSIZE='offsetof(pl_engine, read_settings) - 1'", "ends before read_frame"},
        {"many.so", "-DPROFILES=65", "profile_count: expected 1 to 64, found 65"},
        {"name.so", "-DENGINE_NAME=NULL", "lacks name"},
        {"space.so", "-DENGINE_NAME='\"my engine\"'", "name: expected 1 to 63 letters"},
        {"escape.so", "-DENGINE_NAME='\"\\033[31m\"'", "name: expected 1 to 63 letters"},
        {"profile.so", "-DPROFILE_NAME=NULL", "profiles[0].name: expected"},
        {"comma.so", "-DPROFILE_NAME='\"a,b\"'", "profiles[0].name: expected"},
        {"option.so", "-DOPTION_NAME='\"a=b\"'", "options[0].name: expected"},
        {"twice.so", "-DOPTION_NAME='\"stiffness\"'", "options[1].name: stiffness is taken"},
        {"label.so", "-DOPTION_NAME='\"label\"'", "options[0].name: label is taken"},
        {"profile2.so", "-DPROFILE_NAME='\"slow\"'", "profiles[1].name: slow is taken"},
        {"default.so", "-DITERATIONS=101", "its default 101 is not within 1 to 100"},
        {"slow.so", "-DSTIFFNESS=2",
         "profile slow: the default 2 of option stiffness is not within"},
        {"tune.so", "-DTUNE=.tune_profiles=1,.tune_min=0,.tune_max=9",
         "is no range within 1 to 100"},
        {"none.so", "-DOPTION_NAME=NULL", "options[0].name: expected"},
        {"contacts.so", "-DMORE=,.contacts=1", "lacks read_contacts"},
        {"bits.so", "-DMORE=',.contacts=9,.read_contacts=(void*)1'",
         "contacts: expected PL_CONTACTS"},
        {"sources.so", "-DMORE=,.source_count=1", "source_count is 1, but sources is NULL"},
        {"cited.so",
         "-DMORE=',.sources=(const pl_engine_source[]){{1,\"stiff\",\"manual\"}},.source_count=1'",
         "sources[0].option: it has no option stiff"},
        {"of.so",
         "-DMORE=',.sources=(const pl_engine_source[]){{2,NULL,\"manual\"}},.source_count=1'",
         "sources[0].profile: expected 0 to 1, found 2"},
        {"precision.so", "-DMORE=,.precision=7", "precision: expected 0 to 1, found 7"},
        {"integrator.so", "-DMORE=,.integrator=-1", "integrator: expected 0 to 3"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char spec[256];
        build_object(cases[i].name, cases[i].flags);
        in_folder(cases[i].name, spec);
        assert_refused(spec, PL_BAD_INPUT, cases[i].part, cases[i].name);
    }
}

/* A table that ends where a field is optional, or holds more than is known here. */
static void test_shorter_and_longer_tables_are_taken(void **state)
{
    (void)state;
    static const struct {
        const char *name, *flags;
        bool reads_settings;
    } cases[] = {
        {"least.so",
         "-DSIZE='offsetof(pl_engine, read_settings)' -DMORE=',.read_settings=(void*)1'", false},
        {"no_extension.so",
         "-DSIZE='offsetof(pl_engine, extension)' "
         "-DMORE=',.read_settings=(void*)1,.extension=(void*)1'",
         true},
        {"longer.so", "-DSIZE='sizeof(pl_engine) + 64' -DMORE=',.read_settings=(void*)1'", true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char spec[256];
        build_object(cases[i].name, cases[i].flags);
        in_folder(cases[i].name, spec);
        pl_engine_choice choice = choose(spec);
        assert_false(choice.engine->fault.is_fault);
        assert_string_equal(choice.engine->name, "mine");
        assert_int_equal(choice.engine->reads_settings, cases[i].reads_settings);
    }
}

/* An engine that ends its process while it is loaded is still listed, with one profile. */
static void test_engine_that_cannot_be_loaded_has_one_profile(void **state)
{
    (void)state;
    char spec[256];
    build_object("ends.so", "-DRESULT='({ extern void _exit(int); _exit(7); &engine; })'");
    in_folder("ends.so", spec);
    const pl_engine_choice choice = choose(spec);
    assert_true(choice.engine->fault.is_fault);
    assert_contains(choice.engine->fault.reason, "7");
    assert_string_equal(choice.engine->name, "ends.so");
    assert_int_equal(choice.engine->profile_count, 1);
    assert_int_equal(choice.engine->option_count, 0);
    assert_int_equal(choice.engine->substeps, 1);
}

static void test_invalid_shared_object_is_refused_with_loader_reason(void **state)
{
    (void)state;
    char spec[256];
    in_folder("template.c", spec);
    assert_refused(spec, PL_BAD_INPUT, "cannot load", "template.c");
    in_folder("absent.so:fast", spec);
    assert_refused(spec, PL_BAD_INPUT, "cannot load", "absent.so");
    assert_refused("absent.so", PL_BAD_INPUT, "cannot load absent.so", "No such file");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_engines_are_listed_with_plumb_first),
        cmocka_unit_test(test_bare_engine_name_is_its_first_profile),
        cmocka_unit_test(test_profile_defaults_come_before_the_users_options),
        cmocka_unit_test(test_labels_distinguish_numbers_by_the_last_bit),
        cmocka_unit_test(test_path_may_contain_colon_and_comma),
        cmocka_unit_test(test_misspelt_names_get_the_nearest_suggested),
        cmocka_unit_test(test_bad_options_are_refused_with_what_was_found),
        cmocka_unit_test(test_a_spec_longer_than_its_field_is_refused),
        cmocka_unit_test(test_shared_objects_of_another_abi_are_refused),
        cmocka_unit_test(test_shorter_and_longer_tables_are_taken),
        cmocka_unit_test(test_engine_that_cannot_be_loaded_has_one_profile),
        cmocka_unit_test(test_invalid_shared_object_is_refused_with_loader_reason),
    };
    return cmocka_run_group_tests_name("registry", tests, make_objects, remove_objects);
}
