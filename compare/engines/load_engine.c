#include "load_engine.h"

#include "adapters/process/adapter_process.h"
#include "base/hash.h"
#include "base/sanitizer.h"
#include "engine_info.h"

#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <link.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const uint32_t KNOWN_CONTACTS =
    PL_CONTACTS_POINTS | PL_CONTACTS_IMPULSES | PL_CONTACTS_TORQUES;

/* The name of a required field that is NULL; NULL: none. */
static const char *missing_field(const pl_engine *engine)
{
    return engine->name == NULL          ? "name"
           : engine->version == NULL     ? "version"
           : engine->description == NULL ? "description"
           : engine->profiles == NULL    ? "profiles"
           : engine->create == NULL      ? "create"
           : engine->destroy == NULL     ? "destroy"
           : engine->step == NULL        ? "step"
           : engine->read_frame == NULL  ? "read_frame"
           : engine->contacts != 0 && engine->read_contacts == NULL
               ? "read_contacts, though its contacts are not 0"
               : NULL;
}

static pl_status check_counts(const char *path, const pl_engine *engine, pl_error *error)
{
    const struct {
        const char *what;
        int found, least, most;
    } counts[] = {
        {"profile_count", engine->profile_count, 1, PL_ENGINE_MAX_PROFILES},
        {"option_count", engine->option_count, 0, PL_ENGINE_MAX_OPTIONS},
        {"source_count", engine->source_count, 0, PL_ENGINE_MAX_SOURCES},
        {"substeps", engine->substeps, 1, 1000000},
        {"precision", (int)engine->precision, PL_PRECISION_DOUBLE, PL_PRECISION_FLOAT},
        {"integrator", (int)engine->integrator, PL_INTEGRATOR_UNKNOWN, PL_INTEGRATOR_MIDPOINT},
        {"gyroscopic", (int)engine->gyroscopic, PL_GYROSCOPIC_UNKNOWN, PL_GYROSCOPIC_IMPLICIT},
    };
    for (size_t i = 0; i < sizeof counts / sizeof *counts; ++i) {
        if (counts[i].found < counts[i].least || counts[i].found > counts[i].most) {
            return pl_fail(error, PL_BAD_INPUT, "%s: %s: expected %d to %d, found %d", path,
                           counts[i].what, counts[i].least, counts[i].most, counts[i].found);
        }
    }
    if (engine->option_count > 0 && engine->options == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "%s: option_count is %d, but options is NULL", path,
                       engine->option_count);
    }
    if (engine->source_count > 0 && engine->sources == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "%s: source_count is %d, but sources is NULL", path,
                       engine->source_count);
    }
    if ((engine->contacts & ~KNOWN_CONTACTS) != 0) {
        return pl_fail(error, PL_BAD_INPUT, "%s: contacts: expected PL_CONTACTS_* bits, found 0x%x",
                       path, (unsigned)engine->contacts);
    }
    return PL_OK;
}

/* A name, profile or option of a SPEC. */
static bool is_word(const char *text)
{
    return text != NULL && text[0] != '\0' && strlen(text) < PL_NAME_SIZE &&
           text[strspn(
               text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-")] == '\0';
}

static const char *const WORD_EXPECTED = "expected 1 to 63 letters, digits, '_', '-' or '.'";

static pl_status check_profiles(const char *path, const pl_engine *engine, pl_error *error)
{
    for (int i = 0; i < engine->profile_count; ++i) {
        const char *name = engine->profiles[i].name;
        if (!is_word(name)) {
            return pl_fail(error, PL_BAD_INPUT, "%s: profiles[%d].name: %s", path, i,
                           WORD_EXPECTED);
        }
        for (int k = 0; k < i; ++k) {
            if (strcmp(engine->profiles[k].name, name) == 0) {
                return pl_fail(error, PL_BAD_INPUT, "%s: profiles[%d].name: %s is taken", path, i,
                               name);
            }
        }
    }
    return PL_OK;
}

static pl_status check_numbers(const char *path, const pl_engine_option *o, pl_error *error)
{
    if (!isfinite(o->min) || !isfinite(o->max)) {
        return pl_fail(error, PL_BAD_INPUT, "%s: option %s: its limits must be finite", path,
                       o->name);
    }
    if (!(o->min <= o->value && o->value <= o->max)) {
        return pl_fail(error, PL_BAD_INPUT, "%s: option %s: its default %g is not within %g to %g",
                       path, o->name, o->value, o->min, o->max);
    }
    const bool is_range = o->min <= o->tune_min && o->tune_min < o->tune_max &&
                          o->tune_max <= o->max && (!o->tune_logarithmic || o->tune_min > 0);
    if (o->tune_profiles != 0 && !is_range) {
        return pl_fail(error, PL_BAD_INPUT,
                       "%s: option %s: tune_min %g to tune_max %g is no %srange within %g to %g",
                       path, o->name, o->tune_min, o->tune_max,
                       o->tune_logarithmic ? "logarithmic " : "", o->min, o->max);
    }
    return PL_OK;
}

static pl_status check_options(const char *path, const pl_engine *engine, pl_error *error)
{
    pl_status status = PL_OK;
    for (int i = 0; i < engine->option_count && status == PL_OK; ++i) {
        const char *name = engine->options[i].name;
        if (!is_word(name)) {
            return pl_fail(error, PL_BAD_INPUT, "%s: options[%d].name: %s", path, i, WORD_EXPECTED);
        }
        bool is_taken = strcmp(name, "label") == 0; /* label= is the harness's own */
        for (int k = 0; k < i; ++k) {
            is_taken = is_taken || strcmp(engine->options[k].name, name) == 0;
        }
        status = is_taken ? pl_fail(error, PL_BAD_INPUT, "%s: options[%d].name: %s is taken", path,
                                    i, name)
                          : check_numbers(path, &engine->options[i], error);
    }
    return status;
}

static bool has_option(const pl_engine *engine, const char *name)
{
    for (int i = 0; i < engine->option_count; ++i) {
        if (strcmp(engine->options[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

static pl_status check_sources(const char *path, const pl_engine *engine, pl_error *error)
{
    for (int i = 0; i < engine->source_count; ++i) {
        const pl_engine_source *source = &engine->sources[i];
        if (source->profile < 0 || source->profile >= engine->profile_count) {
            return pl_fail(error, PL_BAD_INPUT,
                           "%s: sources[%d].profile: expected 0 to %d, found %d", path, i,
                           engine->profile_count - 1, source->profile);
        }
        if (source->option != NULL && !has_option(engine, source->option)) {
            return pl_fail(error, PL_BAD_INPUT, "%s: sources[%d].option: it has no option %s", path,
                           i, source->option);
        }
        if (source->text == NULL || source->text[0] == '\0') {
            return pl_fail(error, PL_BAD_INPUT, "%s: sources[%d].text: expected a text", path, i);
        }
    }
    return PL_OK;
}

static pl_status check_words(const char *path, const pl_engine *engine, pl_error *error)
{
    if (!is_word(engine->name)) {
        return pl_fail(error, PL_BAD_INPUT, "%s: name: %s", path, WORD_EXPECTED);
    }
    pl_status status = check_profiles(path, engine, error);
    if (status == PL_OK) {
        status = check_options(path, engine, error);
    }
    return status == PL_OK ? check_sources(path, engine, error) : status;
}

static pl_status check_sizes(const char *path, const pl_engine *engine, pl_error *error)
{
    if (engine == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "%s: " PL_ENGINE_SYMBOL "() returned no engine", path);
    }
    if (engine->abi_version != PL_ENGINE_ABI_VERSION) {
        return pl_fail(error, PL_BAD_INPUT,
                       "%s: is built for engine ABI %u, this plumb has %d: rebuild it", path,
                       (unsigned)engine->abi_version, (int)PL_ENGINE_ABI_VERSION);
    }
    /* Everything up to read_frame must be there. */
    static const struct {
        const char *name;
        size_t end;
    } fields[] = {{"name", offsetof(pl_engine, version)},
                  {"profiles", offsetof(pl_engine, profile_count)},
                  {"create", offsetof(pl_engine, destroy)},
                  {"destroy", offsetof(pl_engine, step)},
                  {"step", offsetof(pl_engine, read_frame)},
                  {"read_frame", offsetof(pl_engine, read_settings)}};
    for (size_t i = 0; i < sizeof fields / sizeof *fields; ++i) {
        if (engine->struct_size < fields[i].end) {
            return pl_fail(error, PL_BAD_INPUT,
                           "%s: its pl_engine has %u bytes and ends before %s: rebuild it", path,
                           (unsigned)engine->struct_size, fields[i].name);
        }
    }
    return PL_OK;
}

static pl_status take_table(const char *path, const pl_engine *engine, pl_engine *table,
                            pl_error *error)
{
    pl_status status = check_sizes(path, engine, error);
    if (status != PL_OK) {
        return status;
    }
    memset(table, 0, sizeof *table);
    memcpy(table, engine,
           engine->struct_size < sizeof *table ? engine->struct_size : sizeof *table);
    const char *missing = missing_field(table);
    if (missing != NULL) {
        return pl_fail(error, PL_BAD_INPUT, "%s: its pl_engine lacks %s", path, missing);
    }
    status = check_counts(path, table, error);
    return status == PL_OK ? check_words(path, table, error) : status;
}

/* Symbols of the engine come before those of the libraries of this program: an engine of which
 * another build is linked to this program uses its own. No sanitizer allows it. */
enum { LOAD_FLAGS = RTLD_NOW | RTLD_LOCAL | (PL_SANITIZER ? 0 : RTLD_DEEPBIND) };

static pl_status load_program(const char *command, pl_loaded_engine *loaded, pl_error *error)
{
    pl_engine table;
    char label[200];
    pl_error cause = {.message = ""};
    snprintf(label, sizeof label, "exec:%.180s", command);
    const pl_status status = pl_process_engine_open(command, &table, &cause);
    if (status != PL_OK) {
        return pl_fail(error, status, "%s: %s", label, cause.message);
    }
    loaded->is_program = true;
    return take_table(label, &table, &loaded->table, error);
}

static pl_status load_library(const char *path, pl_loaded_engine *loaded, pl_error *error)
{
    /* Absolute: dlopen looks for a bare name in the system's folders, and a constructor may change
     * the folder before the binary is hashed. */
    char absolute[PATH_MAX];
    if (realpath(path, absolute) == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "cannot load %s: %s", path, strerror(errno));
    }
    loaded->library = dlopen(absolute, LOAD_FLAGS);
    if (loaded->library == NULL) {
        return pl_fail(error, PL_BAD_INPUT, "cannot load %s: %s", path, dlerror());
    }
    union { /* ISO C has no conversion from an object's address to a function's. */
        void *object;
        pl_engine_entry function;
    } symbol = {.object = dlsym(loaded->library, PL_ENGINE_SYMBOL)};
    return symbol.object == NULL
               ? pl_fail(error, PL_BAD_INPUT, "%s: exports no " PL_ENGINE_SYMBOL, path)
               : take_table(path, symbol.function(), &loaded->table, error);
}

pl_status pl_load_engine(const pl_engine_info *info, pl_loaded_engine *loaded, pl_error *error)
{
    *loaded = (pl_loaded_engine){.library = NULL};
    const pl_float_environment environment = pl_float_environment_save();
    const pl_status status =
        info->path != NULL ? load_library(info->path, loaded, error)
        : info->command != NULL
            ? load_program(info->command, loaded, error)
            : take_table("built-in engine", info->built_in->entry(), &loaded->table, error);
    loaded->changed_modes = pl_float_environment_restore(&environment);
    if (status != PL_OK) {
        pl_unload_engine(loaded);
    }
    return status;
}

void pl_unload_engine(pl_loaded_engine *loaded)
{
    const pl_float_environment environment = pl_float_environment_save();
    if (loaded->library != NULL) {
        dlclose(loaded->library);
    }
    if (loaded->is_program) {
        pl_process_engine_close();
    }
    pl_float_environment_restore(&environment);
    *loaded = (pl_loaded_engine){.library = NULL};
}

/* ---- The binary ---- */

static int count_file(struct dl_phdr_info *info, size_t size, void *count)
{
    (void)info;
    (void)size;
    *(int *)count += 1;
    return 0;
}

int pl_mapped_file_count(void)
{
    int count = 0;
    dl_iterate_phdr(count_file, &count);
    return count;
}

typedef struct hashing {
    int first, index;
    const char *libraries; /* NULL: all from `first` on */
    /* Adds a file to the hash. Returns errno; 0: done. */
    int (*add)(const char *path, uint64_t *hash);
    uint64_t hash;
    int error; /* errno */
} hashing;

static bool is_one_of(const char *path, const char *libraries)
{
    const char *slash = strrchr(path, '/');
    const char *name = slash == NULL ? path : slash + 1;
    for (const char *at = libraries; *at != '\0';) {
        const size_t length = strcspn(at, " ");
        if (strncmp(name, at, length) == 0) {
            return true;
        }
        at += length + strspn(at + length, " ");
    }
    return false;
}

static int add_contents(const char *path, uint64_t *hash)
{
    unsigned char bytes[1 << 16];
    size_t length = 0;
    FILE *file = fopen(path, "re");
    if (file == NULL) {
        return errno;
    }
    while ((length = fread(bytes, 1, sizeof bytes, file)) > 0) {
        for (size_t i = 0; i < length; ++i) {
            *hash = pl_hash_byte(*hash, bytes[i]);
        }
    }
    const int fault = ferror(file) != 0 ? EIO : 0;
    fclose(file);
    return fault;
}

static int add_identity(const char *path, uint64_t *hash)
{
    struct stat found;
    char text[160];
    if (stat(path, &found) != 0) {
        return errno;
    }
    snprintf(text, sizeof text, "%ju %ju %jd %jd %ld\n", (uintmax_t)found.st_dev,
             (uintmax_t)found.st_ino, (intmax_t)found.st_size, (intmax_t)found.st_mtim.tv_sec,
             found.st_mtim.tv_nsec);
    *hash = pl_hash_text(*hash, text);
    return 0;
}

static int hash_file(struct dl_phdr_info *info, size_t size, void *user)
{
    hashing *h = user;
    const int index = h->index++;
    /* The first is the program, without a name; the kernel's own has a name that is no path. */
    const char *path = index == 0 ? "/proc/self/exe" : info->dlpi_name;
    const bool wanted =
        h->libraries == NULL ? index >= h->first : index == 0 || is_one_of(path, h->libraries);
    (void)size;
    if (!wanted || strchr(path, '/') == NULL) {
        return 0;
    }
    h->error = h->add(path, &h->hash);
    return h->error;
}

static pl_status hash_mapped(hashing *h, char hash[17], pl_error *error)
{
    h->hash = PL_HASH_START;
    dl_iterate_phdr(hash_file, h);
    if (h->error != 0) {
        return pl_fail(error, PL_IO, "cannot read the engine's binary: %s", strerror(h->error));
    }
    pl_hash_hex(h->hash, hash);
    return PL_OK;
}

static pl_status hash_program(char hash[17], pl_error *error)
{
    uint64_t value = PL_HASH_START;
    const char *path;
    for (int i = 0; (path = pl_process_engine_file(i)) != NULL; ++i) {
        const int fault = add_contents(path, &value);
        if (fault != 0) {
            return pl_fail(error, PL_IO, "cannot read %s: %s", path, strerror(fault));
        }
    }
    pl_hash_hex(value, hash);
    return PL_OK;
}

pl_status pl_binary_hash(const pl_engine_info *info, int first, char hash[17], pl_error *error)
{
    hashing h = {.first = first,
                 .libraries = info->path == NULL && info->built_in != NULL
                                  ? info->built_in->libraries
                                  : NULL,
                 .add = add_contents};
    return info->path == NULL && info->command != NULL ? hash_program(hash, error)
                                                       : hash_mapped(&h, hash, error);
}

pl_status pl_binary_stamp(int first, char stamp[17], pl_error *error)
{
    hashing h = {.first = first, .add = add_identity};
    return hash_mapped(&h, stamp, error);
}

void pl_file_hash(const char *path, char hash[17])
{
    uint64_t value = PL_HASH_START;
    hash[0] = '\0';
    if (add_contents(path, &value) == 0) {
        pl_hash_hex(value, hash);
    }
}
