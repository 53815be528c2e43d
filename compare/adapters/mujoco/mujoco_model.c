/* A scene becomes a compiled model: MuJoCo takes MJCF only, which is given to it in memory. */
#include "mujoco_instance.h"

#include "mjcf.h"

#include <stdlib.h>

static const char file_name[] = "scene.xml";
static const double gibibyte = 0x1p30;

/* MuJoCo ends the program when it finds no memory, so it is asked for before. */
static pl_status check_sizes(const pl_scene *scene, const pl_mujoco_sizes *sizes, pl_error *error)
{
    if (sizes->contacts == 0) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "%d bodies: MuJoCo 2.2 counts its memory in 32 bits, which are too few",
                       scene->body_count);
    }
    void *probe = malloc((size_t)sizes->bytes);
    if (probe == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "MuJoCo needs %.1f GiB for %d bodies and %d contacts",
                       sizes->bytes / gibibyte, scene->body_count, sizes->contacts);
    }
    free(probe);
    return PL_OK;
}

static pl_status compile(const pl_text_buffer *text, pl_engine_instance *instance, pl_error *error)
{
    char message[1024] = "";
    mjVFS *files = malloc(sizeof *files);
    if (files == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    mj_defaultVFS(files);
    if (mj_makeEmptyFileVFS(files, file_name, (int)text->length) == 0) {
        memcpy(files->filedata[0], text->data, text->length);
        instance->model = mj_loadXML(file_name, files, message, sizeof message);
    }
    mj_deleteVFS(files);
    free(files);
    mj_freeLastXML();
    return instance->model != NULL
               ? PL_OK
               : pl_fail(error, PL_UNSUPPORTED, "MuJoCo takes no such model: %.400s", message);
}

/* Matches the geoms with the bodies of the scene: planes first (mjcf.h). */
static pl_status match_geoms(pl_engine_instance *instance, pl_error *error)
{
    const pl_scene *scene = instance->scene;
    size_t count = (size_t)scene->body_count + 1;
    instance->geoms = calloc(count, sizeof *instance->geoms);
    instance->bodies = calloc(count, sizeof *instance->bodies);
    if (instance->geoms == NULL || instance->bodies == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    int geom = 0;
    for (int planes = 1; planes >= 0; --planes) {
        for (int i = 0; i < scene->body_count; ++i) {
            if ((scene->bodies[i].shape.kind == PL_SHAPE_PLANE) == planes) {
                instance->geoms[i] = geom;
                instance->bodies[geom++] = i;
            }
        }
    }
    return instance->model->ngeom == scene->body_count
               ? PL_OK
               : pl_fail(error, PL_FAILED, "MuJoCo made %d geoms of %d bodies",
                         instance->model->ngeom, scene->body_count);
}

static void set_contact_softness(const double *values, mjtNum *solref, mjtNum *solimp)
{
    solref[0] = values[OPTION_SOLREF_TIMECONST];
    solref[1] = values[OPTION_SOLREF_DAMPRATIO];
    solimp[0] = values[OPTION_SOLIMP_DMIN];
    solimp[1] = values[OPTION_SOLIMP_DMAX];
    solimp[2] = values[OPTION_SOLIMP_WIDTH];
}

static void set_options(mjModel *model, double dt, const double *values)
{
    mjOption *option = &model->opt;
    option->timestep = dt;
    option->solver = (int)values[OPTION_SOLVER];
    option->cone = (int)values[OPTION_CONE];
    option->iterations = (int)values[OPTION_ITERATIONS];
    option->tolerance = values[OPTION_TOLERANCE];
    option->noslip_iterations = (int)values[OPTION_NOSLIP_ITERATIONS];
    option->noslip_tolerance = values[OPTION_NOSLIP_TOLERANCE];
    option->impratio = values[OPTION_IMPRATIO];
    option->enableflags |= values[OPTION_MULTICCD] != 0 ? mjENBL_MULTICCD : 0;
    for (int i = 0; i < model->ngeom; ++i) {
        set_contact_softness(values, &model->geom_solref[mjNREF * i],
                             &model->geom_solimp[mjNIMP * i]);
    }
    for (int i = 0; i < model->npair; ++i) {
        set_contact_softness(values, &model->pair_solref[mjNREF * i],
                             &model->pair_solimp[mjNIMP * i]);
    }
}

/* Data for the sizes of the model. They grow as contacts ask for it, so that MuJoCo's message of a
 * full buffer would mislead: it is printed for the first of its kind only. */
static pl_status make_data(pl_engine_instance *instance, pl_error *error)
{
    instance->data = mj_makeData(instance->model);
    if (instance->data == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "MuJoCo could not make its data for %d contacts",
                       instance->contacts);
    }
    instance->data->warning[mjWARN_CONTACTFULL].number = 1;
    instance->data->warning[mjWARN_CNSTRFULL].number = 1;
    return PL_OK;
}

pl_status pl_mujoco_load(const pl_engine_setup *setup, pl_engine_instance *instance,
                         pl_error *error)
{
    const pl_scene *scene = setup->scene;
    pl_mujoco_sizes sizes = pl_mujoco_sizes_for(scene, pl_mujoco_first_contacts(scene));
    pl_text_buffer text = {0};
    instance->contacts = sizes.contacts;
    pl_status status = check_sizes(scene, &sizes, error);
    if (status == PL_OK) {
        status = pl_mjcf_write(scene, &text, error);
    }
    if (status == PL_OK) {
        status = compile(&text, instance, error);
    }
    pl_text_free(&text);
    if (status == PL_OK) {
        status = match_geoms(instance, error);
    }
    if (status == PL_OK) {
        set_options(instance->model, setup->dt, setup->values);
        status = make_data(instance, error);
    }
    for (int i = 0; status == PL_OK && i < scene->body_count; ++i) {
        if (!scene->bodies[i].is_static) {
            int joint = instance->model->body_jntadr[pl_mujoco_body(instance, i)];
            pl_mjcf_velocity(&scene->bodies[i],
                             instance->data->qvel + instance->model->jnt_dofadr[joint]);
        }
    }
    return status;
}

void pl_mujoco_destroy(pl_engine_instance *instance)
{
    if (instance == NULL) {
        return;
    }
    if (instance->data != NULL) {
        mj_deleteData(instance->data);
    }
    if (instance->model != NULL) {
        mj_deleteModel(instance->model);
    }
    free(instance->geoms);
    free(instance->bodies);
    free(instance);
}

pl_status pl_mujoco_grow(pl_engine_instance *instance, pl_error *error)
{
    mjModel *model = instance->model;
    pl_mujoco_sizes sizes = pl_mujoco_sizes_for(instance->scene, 2 * instance->contacts);
    if (sizes.contacts <= instance->contacts) {
        return pl_fail(error, PL_UNSUPPORTED,
                       "more than %d contacts of %d bodies: MuJoCo 2.2 reserves a matrix of all "
                       "contact rows in advance and counts its bytes in 32 bits",
                       instance->contacts, instance->scene->body_count);
    }
    size_t nq = (size_t)model->nq, nv = (size_t)model->nv;
    mjtNum time = instance->data->time;
    mjtNum *kept = malloc((nq + 2 * nv) * sizeof *kept);
    if (kept == NULL) {
        return pl_fail(error, PL_NO_MEMORY, "out of memory");
    }
    memcpy(kept, instance->data->qpos, nq * sizeof *kept);
    memcpy(kept + nq, instance->data->qvel, nv * sizeof *kept);
    memcpy(kept + nq + nv, instance->data->qacc_warmstart, nv * sizeof *kept);
    mj_deleteData(instance->data);
    instance->data = NULL;
    instance->contacts = sizes.contacts;
    model->nconmax = sizes.nconmax;
    model->njmax = sizes.njmax;
    model->nstack = sizes.nstack;
    pl_status status = check_sizes(instance->scene, &sizes, error);
    if (status == PL_OK) {
        status = make_data(instance, error);
    }
    if (status == PL_OK) {
        memcpy(instance->data->qpos, kept, nq * sizeof *kept);
        memcpy(instance->data->qvel, kept + nq, nv * sizeof *kept);
        memcpy(instance->data->qacc_warmstart, kept + nq + nv, nv * sizeof *kept);
        instance->data->time = time;
    }
    free(kept);
    return status;
}
