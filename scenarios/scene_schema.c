/* Prints the scene format from its table of fields: as a JSON Schema (scenarios/scene.schema.json),
 * or with the argument "markdown" as the tables of scenarios/README.md. Tests compare both files
 * with what this program prints. */
#include "base/number.h"
#include "scene/scene_fields.h"

#include <stdio.h>
#include <string.h>

static const char *const definitions =
    "    \"name\": { \"description\": \"at most 63 bytes of UTF-8, no control characters\", "
    "\"type\": \"string\", \"minLength\": 1, \"maxLength\": 63, \"pattern\": "
    "\"^[^\\\\u0000-\\\\u001f\\\\u007f]+$\" },\n"
    "    \"vector\": { \"type\": \"array\", \"items\": { \"type\": [\"number\", \"string\"] }, "
    "\"minItems\": 3, \"maxItems\": 3, \"description\": \"a string is an expression of "
    "parameters\" "
    "},\n"
    "    \"positive_vector\": { \"type\": \"array\", \"items\": { \"type\": [\"number\", "
    "\"string\"], \"exclusiveMinimum\": 0 }, \"minItems\": 3, \"maxItems\": 3 },\n"
    "    \"quaternion\": { \"type\": \"array\", \"items\": { \"type\": [\"number\", \"string\"] }, "
    "\"minItems\": 4, \"maxItems\": 4, \"description\": \"[w, x, y, z], unit, body to world\" },\n";

#define REF(name) "\"$ref\": \"#/$defs/" name "\""

/* The form of a type in README.md, and its JSON Schema where that is one text. */
static const struct {
    const char *form;
    const char *schema;
    const char *positive; /* the schema of positive components */
} types[] = {
    [PL_FIELD_VERSION] = {"1 or 2", "\"enum\": [1, 2]", NULL},
    [PL_FIELD_NUMBER] = {"number", NULL, NULL},
    [PL_FIELD_VECTOR] = {"[x, y, z]", REF("vector"), REF("positive_vector")},
    [PL_FIELD_UNIT] = {"unit [x, y, z]", REF("vector"), NULL},
    [PL_FIELD_QUATERNION] = {"unit [w, x, y, z]", REF("quaternion"), NULL},
    [PL_FIELD_INERTIA] = {"[x, y, z]", REF("vector"), REF("positive_vector")},
    [PL_FIELD_BOOL] = {"true or false", "\"type\": \"boolean\"", NULL},
    [PL_FIELD_NAME] = {"name", REF("name"), NULL},
    [PL_FIELD_METRIC] = {"metric", NULL, NULL},
    [PL_FIELD_MATERIAL] = {"name of a material", "\"type\": \"string\"", NULL},
    [PL_FIELD_BODY] = {"name of a body", "\"type\": \"string\"", NULL},
    [PL_FIELD_OBJECT] = {"object", NULL, NULL},
    [PL_FIELD_ITEMS] = {"array of", NULL, NULL},
    [PL_FIELD_NAMED_ITEMS] = {"object of", NULL, NULL},
    [PL_FIELD_FORCES] = {"array of", NULL, NULL},
    [PL_FIELD_SHAPES] = {"object of shapes", NULL, NULL},
    [PL_FIELD_SHAPE] = {"shape or its name",
                        "\"oneOf\": [{ " REF("name") " }, { " REF("shape") " }]", NULL},
    [PL_FIELD_POINTS] = {"array of [x, y, z]",
                         "\"type\": \"array\", \"items\": { " REF("vector") " }", NULL},
    [PL_FIELD_TRIANGLES] = {"array of [i, j, k]",
                            "\"type\": \"array\", \"items\": { \"type\": \"array\", \"items\": { "
                            "\"type\": \"integer\", \"minimum\": 0 }, \"minItems\": 3, "
                            "\"maxItems\": 3 }",
                            NULL},
    [PL_FIELD_DENSITY] = {"number", NULL, NULL},
    [PL_FIELD_FILE] = {"file name", "\"type\": \"string\"", NULL},
    [PL_FIELD_TEXT] = {"text", "\"type\": \"string\", \"maxLength\": 255", NULL},
    [PL_FIELD_PARAMETERS] = {"object of", NULL, NULL},
};

static int component_count(const pl_field *field)
{
    return field->type == PL_FIELD_VECTOR ? 3 : field->type == PL_FIELD_QUATERNION ? 4 : 1;
}

/* The default of a number, vector, quaternion, word or boolean. */
static void print_default(const pl_object *object, const pl_field *field)
{
    const void *value = pl_field_of(field, object->defaults);
    const int count = component_count(field);
    char text[PL_NUMBER_SIZE];
    int index;
    if (field->type == PL_FIELD_BOOL) {
        printf("%s", *(const bool *)value ? "true" : "false");
    } else if (field->type == PL_FIELD_WORD) {
        memcpy(&index, value, sizeof index);
        printf("\"%s\"", field->words[index]);
    } else {
        for (int k = 0; k < count; ++k) {
            const double number = ((const double *)value)[k];
            printf("%s%s", k > 0 ? ", " : count > 1 ? "[" : "", pl_number_text(number, text));
        }
        printf("%s", count > 1 ? "]" : "");
    }
}

/* Unit and meaning as one text, in quotes or not. */
static void print_about(const pl_field *field, const char *quote)
{
    for (const char *c = field->about != NULL ? field->about : ""; *c != '\0'; ++c) {
        printf("%s%c", *c == '"' && *quote != '\0' ? "\\" : "", *c);
    }
}

/* ---- JSON Schema ---- */

static void print_words(const pl_field *field)
{
    printf("\"enum\": [%s", field->type == PL_FIELD_METRIC ? "\"\", " : "");
    for (int i = 0; i < field->word_count; ++i) {
        printf("%s\"%s\"", i == 0 ? "" : ", ", field->words[i]);
    }
    printf("]");
}

static void print_limits(const pl_field *field, const char *noun)
{
    if (field->least > 0) {
        printf(", \"min%s\": %d", noun, field->least);
    }
    if (field->most > 0) {
        printf(", \"max%s\": %d", noun, field->most);
    }
}

/* A string is an expression of parameters; the parameters' own numbers are none. */
static const char *number_type(const pl_field *field, const char *object)
{
    const bool is_parameter = strcmp(object, pl_objects[PL_OBJECT_PARAMETER].name) == 0;
    return is_parameter      ? "\"number\""
           : field->nullable ? "[\"number\", \"string\", \"null\"]"
                             : "[\"number\", \"string\"]";
}

/* The members of the JSON Schema that state a field's type. */
static void print_type(const pl_field *field, const char *object)
{
    const char *items = pl_objects[field->items].name;
    switch (field->type) {
    case PL_FIELD_TYPE:
        printf("\"const\": \"%s\"", object);
        break;
    case PL_FIELD_NUMBER:
    case PL_FIELD_DENSITY:
        printf("\"type\": %s%s", number_type(field, object), pl_range_rules[field->range].schema);
        break;
    case PL_FIELD_PARAMETERS:
        printf(
            "\"type\": \"object\", \"propertyNames\": { \"pattern\": "
            "\"^[A-Za-z_][A-Za-z0-9_]*$\" }, \"additionalProperties\": { \"oneOf\": [{ \"type\": "
            "\"number\" }, { \"$ref\": \"#/$defs/%s\" }] }",
            items);
        break;
    case PL_FIELD_WORD:
    case PL_FIELD_METRIC:
        print_words(field);
        break;
    case PL_FIELD_OBJECT:
        printf("\"$ref\": \"#/$defs/%s\"", items);
        break;
    case PL_FIELD_ITEMS:
    case PL_FIELD_FORCES:
        printf("\"type\": \"array\", \"items\": { \"$ref\": \"#/$defs/%s\" }", items);
        break;
    case PL_FIELD_NAMED_ITEMS:
    case PL_FIELD_SHAPES:
        printf("\"type\": \"object\", \"propertyNames\": { \"$ref\": \"#/$defs/name\" }, "
               "\"additionalProperties\": { \"$ref\": \"#/$defs/%s\" }",
               field->type == PL_FIELD_SHAPES ? "shape" : items);
        break;
    default:
        printf("%s", field->range == PL_RANGE_POSITIVE && types[field->type].positive != NULL
                         ? types[field->type].positive
                         : types[field->type].schema);
        break;
    }
    const bool is_object =
        field->type == PL_FIELD_NAMED_ITEMS || field->type == PL_FIELD_PARAMETERS;
    print_limits(field, is_object ? "Properties" : "Items");
}

static void print_object(pl_object_kind kind, const char *indent)
{
    const pl_object *object = &pl_objects[kind];
    const char *before = "";
    printf(
        "%s\"description\": \"%s\",\n%s\"type\": \"object\",\n%s\"additionalProperties\": false,\n",
        indent, object->about, indent, indent);
    printf("%s\"required\": [", indent);
    for (int i = 0; i < object->field_count; ++i) {
        if (object->fields[i].need == PL_NEED_ALWAYS) {
            printf("%s\"%s\"", before, object->fields[i].key);
            before = ", ";
        }
    }
    printf("],\n");
    if (object->schema != NULL) {
        printf("%s%s,\n", indent, object->schema);
    }
    printf("%s\"properties\": {\n", indent);
    for (int i = 0; i < object->field_count; ++i) {
        const pl_field *field = &object->fields[i];
        printf("%s  \"%s\": { ", indent, field->key);
        print_type(field, object->name);
        if (field->need == PL_NEED_DEFAULT) {
            printf(", \"default\": ");
            print_default(object, field);
        }
        if (field->unit != NULL || field->about != NULL) {
            printf(", \"description\": \"%s%s", field->unit != NULL ? field->unit : "",
                   field->unit != NULL && field->about != NULL ? ", " : "");
            print_about(field, "\"");
            printf("\"");
        }
        printf(" }%s\n", i + 1 < object->field_count ? "," : "");
    }
    printf("%s}", indent);
}

static void print_schema(void)
{
    printf("{\n  \"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n"
           "  \"title\": \"Plumb scene\",\n");
    print_object(PL_OBJECT_SCENE, "  ");
    printf(",\n  \"$defs\": {\n%s", definitions);
    printf("    \"shape\": { \"type\": \"object\", \"required\": [\"type\"], \"oneOf\": [");
    for (int i = 0; i < PL_SHAPE_KIND_COUNT; ++i) {
        printf("%s{ \"$ref\": \"#/$defs/%s\" }", i == 0 ? "" : ", ", pl_shape_names[i]);
    }
    printf("] }");
    for (int kind = PL_OBJECT_SCENE + 1; kind < PL_OBJECT_COUNT; ++kind) {
        printf(",\n    \"%s\": {\n", pl_objects[kind].name);
        print_object((pl_object_kind)kind, "      ");
        printf("\n    }");
    }
    printf("\n  }\n}\n");
}

/* ---- Markdown ---- */

/* The form of a field's value, such as "number, m". */
static void print_form(const pl_field *field)
{
    if (field->type == PL_FIELD_WORD) {
        for (int i = 0; i < field->word_count; ++i) {
            printf("%s\"%s\"", i == 0 ? "" : ", ", field->words[i]);
        }
        return;
    }
    const size_t end = strlen(types[field->type].form);
    const bool has_items = end > 3 && strcmp(types[field->type].form + end - 3, " of") == 0;
    printf("%s%s%s%s%s", types[field->type].form, has_items ? " " : "",
           has_items ? pl_objects[field->items].name : "", field->unit != NULL ? ", " : "",
           field->unit != NULL ? field->unit : "");
}

static void print_tables(void)
{
    printf("| object | key | value | default | meaning |\n|---|---|---|---|---|\n");
    for (int kind = 0; kind < PL_OBJECT_COUNT; ++kind) {
        const pl_object *object = &pl_objects[kind];
        const bool shared = kind + 1 < PL_OBJECT_COUNT && object[1].fields == object->fields;
        for (int i = 0; i < object->field_count && !shared; ++i) {
            const pl_field *field = &object->fields[i];
            if (field->type == PL_FIELD_TYPE) {
                continue; /* the object's name */
            }
            const bool two = kind > 0 && object[-1].fields == object->fields;
            printf("| %s%s%s | `%s` | ", two ? object[-1].name : "", two ? ", " : "", object->name,
                   field->key);
            print_form(field);
            printf(" | ");
            if (field->need == PL_NEED_DEFAULT) {
                print_default(object, field);
            } else if (field->need == PL_NEED_ALWAYS) {
                printf("required");
            }
            printf(" | ");
            print_about(field, "");
            printf(" |\n");
        }
    }
}

int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "markdown") == 0) {
        print_tables();
    } else {
        print_schema();
    }
    return ferror(stdout) != 0;
}
