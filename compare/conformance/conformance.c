/* Runs checks, each in a process that answers with one JSON object. */
#include "conformance.h"

#include "base/json_field.h"
#include "probe.h"

#include <stdlib.h>
#include <string.h>

const pl_check *pl_conformance_check(int index)
{
    static const pl_check *const files[] = {
        pl_state_checks,    pl_place_checks,   pl_motion_checks,  pl_mass_checks,   pl_claim_checks,
        pl_material_checks, pl_contact_checks, pl_impulse_checks, pl_conduct_checks};
    for (size_t i = 0; i < sizeof files / sizeof(const pl_check *); ++i) {
        for (const pl_check *check = files[i]; check->name != NULL; ++check, --index) {
            if (index == 0) {
                return check;
            }
        }
    }
    return NULL;
}

/* ---- In the check's process ---- */

typedef struct check_job {
    const pl_check *check;
    const pl_engine_choice *choice;
} check_job;

static void run_and_answer(void *user, FILE *answer)
{
    const check_job *job = user;
    pl_check_result result = {.outcome = PL_CHECK_PASSED};
    pl_probe probe = {.check = job->check,
                      .choice = job->choice,
                      .session = pl_session_begin(job->choice),
                      .scene = pl_scene_default(),
                      .result = &result};
    pl_error error = {.message = ""};
    if (pl_session_load(&probe.session, &error) != PL_OK) {
        pl_probe_fail(&probe, "the engine loads", error.message, "");
    } else {
        job->check->run(&probe);
    }
    pl_session_end(&probe.session);
    pl_scene_free(&probe.scene);
    free(probe.contacts);
    json_t *object = json_pack("{s:i, s:o, s:o, s:o}", "outcome", (int)result.outcome, "expected",
                               pl_json_text(result.expected), "found", pl_json_text(result.found),
                               "cause", pl_json_text(result.cause));
    json_dumpf(object, answer, JSON_COMPACT);
    json_decref(object);
}

/* ---- In the harness's process ---- */

static void copy_text(const json_t *object, const char *key, char text[PL_CHECK_TEXT_SIZE])
{
    snprintf(text, PL_CHECK_TEXT_SIZE, "%s", pl_json_get_text(object, key));
}

/* Skips a check that needs what the engine does not claim. */
static bool is_claimed(const pl_check *check, const pl_engine_info *engine, pl_check_result *result)
{
    const uint32_t missing = check->needs & ~engine->capabilities;
    const char *name = NULL;
    for (uint32_t bit = 1; bit != 0 && name == NULL; bit <<= 1) {
        name = (missing & bit) != 0 ? pl_needs_name(bit) : NULL;
    }
    if (name != NULL) {
        snprintf(result->found, sizeof result->found, "the engine does not claim %s", name);
    } else if ((check->contacts & ~engine->contacts) != 0) {
        snprintf(result->found, sizeof result->found, "the engine does not report contact %s",
                 engine->contacts == 0 ? "points" : "impulses");
    } else {
        return true;
    }
    result->outcome = PL_CHECK_SKIPPED;
    return false;
}

pl_status pl_conformance_run(const pl_check *check, const pl_engine_choice *choice,
                             const pl_limits *limits, pl_check_result *result, pl_error *error)
{
    *result = (pl_check_result){.check = check};
    if (!is_claimed(check, choice->engine, result)) {
        return PL_OK;
    }
    pl_process process;
    pl_status status =
        pl_process_start(&process, limits, run_and_answer, &(check_job){check, choice}, error);
    if (status == PL_OK) {
        status = pl_process_wait(&process, error);
    }
    if (status != PL_OK) {
        return status;
    }
    json_t *object = json_loadb(process.text.data, process.text.length, 0, NULL);
    if (json_is_object(object)) {
        result->outcome = (pl_check_outcome)json_integer_value(json_object_get(object, "outcome"));
        copy_text(object, "expected", result->expected);
        copy_text(object, "found", result->found);
        copy_text(object, "cause", result->cause);
    } else {
        result->outcome = PL_CHECK_FAILED;
        snprintf(result->expected, sizeof result->expected, "the engine lives through the check");
        pl_process_describe_end(&process, limits->timeout, "during the check", result->found,
                                sizeof result->found);
    }
    json_decref(object);
    pl_process_free(&process);
    return PL_OK;
}
