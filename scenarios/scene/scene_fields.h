/* The scene format as data: one table of fields for every object of a scene file. The reader, the
 * writer, the checks and the JSON Schema follow from it. */
#ifndef PLUMB_SCENE_FIELDS_H
#define PLUMB_SCENE_FIELDS_H

#include "base/diagnostic.h"
#include "plumb/scene.h"

#include <string.h>

/* The type of a field: its form in the file, and its type in C. */
typedef enum pl_field_type {
    PL_FIELD_VERSION,    /* the number 1; nothing in C */
    PL_FIELD_NUMBER,     /* double */
    PL_FIELD_VECTOR,     /* double[3] */
    PL_FIELD_UNIT,       /* double[3] of unit length */
    PL_FIELD_QUATERNION, /* double[4] of unit length */
    PL_FIELD_INERTIA, /* double[3] of a pl_body, principal; left out where the shape has the same */
    PL_FIELD_BOOL,    /* bool */
    PL_FIELD_NAME,    /* char[PL_NAME_SIZE] */
    PL_FIELD_WORD,    /* an enumeration: one of `words` */
    PL_FIELD_METRIC,  /* char[PL_NAME_SIZE]: one of `words`, or empty */
    PL_FIELD_MATERIAL,    /* int: the index of a material, by its name */
    PL_FIELD_BODY,        /* int: the index of a body that has a position, by its name */
    PL_FIELD_OBJECT,      /* an object whose fields are of the same struct in C */
    PL_FIELD_ITEMS,       /* an array of objects: a pointer to them, and an int at `count` */
    PL_FIELD_NAMED_ITEMS, /* an object of objects by name: the same in C */
    PL_FIELD_FORCES,      /* an array of forces: those of pl_scene that act on the body */
    PL_FIELD_SHAPES,      /* an object of shapes by name: the named polyhedra of pl_scene */
    PL_FIELD_SHAPE,       /* pl_shape: an object, or the name of one of the scene's shapes */
    PL_FIELD_TYPE,        /* the type of a shape: pl_shape_kind */
    PL_FIELD_POINTS,      /* an array of vectors: the vertices of a pl_shape's polyhedron */
    PL_FIELD_TRIANGLES,   /* an array of three indices each: its triangles */
    PL_FIELD_DENSITY,     /* a number in place of the mass; nothing in C */
    PL_FIELD_FILE,        /* the name of a file; nothing in C */
    PL_FIELD_TEXT,        /* char[PL_TEXT_SIZE] */
    PL_FIELD_PARAMETERS   /* an object of parameters by name (scene_parameters.h); nothing in C */
} pl_field_type;

/* The range of a number, or of each component of a vector. */
typedef enum pl_range {
    PL_RANGE_FINITE,
    PL_RANGE_POSITIVE,
    PL_RANGE_POSITIVE_OR_INFINITE,
    PL_RANGE_NOT_NEGATIVE,
    PL_RANGE_FRACTION, /* 0 to 1 */
    PL_RANGE_NOT_ZERO
} pl_range;

/* Whether a field may be absent. */
typedef enum pl_need {
    PL_NEED_NONE,    /* may be absent, with a meaning that `about` explains */
    PL_NEED_DEFAULT, /* may be absent, and then has the value of the object's defaults */
    PL_NEED_ALWAYS   /* required */
} pl_need;

/* The kinds of objects in a scene file. */
typedef enum pl_object_kind {
    PL_OBJECT_SCENE,
    PL_OBJECT_MATERIAL,
    PL_OBJECT_PAIR,
    PL_OBJECT_BODY,
    PL_OBJECT_PLANE, /* and the other shapes, in the order of pl_shape_kind */
    PL_OBJECT_SPHERE,
    PL_OBJECT_BOX,
    PL_OBJECT_CAPSULE,
    PL_OBJECT_CYLINDER,
    PL_OBJECT_HULL,
    PL_OBJECT_MESH,
    PL_OBJECT_FORCE,
    PL_OBJECT_EXPECT,
    PL_OBJECT_REST,
    PL_OBJECT_TRAVEL,
    PL_OBJECT_VALUE,
    PL_OBJECT_STATISTIC,
    PL_OBJECT_PARAMETER,
    PL_OBJECT_COUNT
} pl_object_kind;

/* The size of a text that describes something, in bytes. */
enum { PL_TEXT_SIZE = 256 };

/* The most parameters of a scene file: a scenario has two more, dt and duration. */
enum { PL_MAX_SCENE_PARAMETERS = 14 };

/* A parameter of a scene file. */
typedef struct pl_scene_parameter {
    char name[PL_NAME_SIZE];
    double value;     /* the default */
    double low, high; /* the range, -INFINITY and INFINITY where it is not given */
    char unit[PL_NAME_SIZE];
    char description[PL_TEXT_SIZE]; /* a line for people; may be empty */
} pl_scene_parameter;

/* A field of an object. */
typedef struct pl_field {
    const char *key;
    pl_field_type type;
    size_t offset; /* of the value in the object's struct */
    pl_need need;
    pl_range range;
    bool omit_default; /* the writer leaves it out where it has the bits of the default */
    bool nullable;     /* null stands for infinity */
    int line;          /* the writer starts a new line where this changes from field to field */
    bool (*applies)(const void *object); /* NULL: always. Else neither checked nor written */
    const char *unit;                    /* NULL: none */
    const char *about;                   /* a description for people; NULL: the key says it */
    const char *const *words;            /* of PL_FIELD_WORD and PL_FIELD_METRIC */
    int word_count;
    pl_object_kind items; /* the kind of the items, or of the object */
    size_t count;         /* offset of the number of items */
    int least;            /* least number of items */
    int most;             /* 0: no limit */
} pl_field;

/* A kind of object. */
typedef struct pl_object {
    const char *name; /* in messages and in the JSON Schema */
    const char *about;
    const char *schema; /* what else the JSON Schema demands, as members; NULL: nothing */
    const pl_field *fields;
    int field_count;
    size_t size;          /* of the struct in C */
    const void *defaults; /* that struct, before anything is read */
} pl_object;

/* By pl_object_kind. */
extern const pl_object pl_objects[PL_OBJECT_COUNT];

/* The numbers of a range: above `least`, or from it where not `open`, up to `most`. */
typedef struct pl_range_rule {
    const char *expected; /* for messages */
    const char *schema;   /* members of a JSON Schema */
    double least;
    double most;
    bool open;
} pl_range_rule;

/* By pl_range. */
extern const pl_range_rule pl_range_rules[];

/* Whether `value` lies in the range; a NaN lies in none. */
bool pl_range_holds(pl_range range, double value);

/* The newest version of the format. Older ones are read alike. */
enum { PL_SCENE_VERSION = 2 };

/* The names of the shapes, by pl_shape_kind. */
extern const char *const pl_shape_names[PL_SHAPE_KIND_COUNT];

/* The field's value in `object`. */
static inline const void *pl_field_of(const pl_field *field, const void *object)
{
    return (const char *)object + field->offset;
}

/* The field's value in `object`, an enumeration or an index. */
static inline int pl_field_index(const pl_field *field, const void *object)
{
    int index; /* an enumeration has the size of an int */
    memcpy(&index, pl_field_of(field, object), sizeof index);
    return index;
}

/* The items of a list in `object`, and their number. */
static inline const char *pl_field_items(const pl_field *field, const void *object, int *count)
{
    const char *items;
    memcpy(&items, pl_field_of(field, object), sizeof items);
    memcpy(count, (const char *)object + field->count, sizeof *count);
    return items;
}

/* Takes back the last step of the path, except after a failure, which the path locates. Returns
 * `right`. */
static inline bool pl_leave(pl_diagnostic *diagnostic, bool right)
{
    if (right) {
        pl_path_pop(&diagnostic->path);
    }
    return right;
}

#endif
