#include "engine_words.h"

#include "base/json_field.h"

#include <stdio.h>
#include <string.h>

/* The file, which compare/CMakeLists.txt builds into the program. */
extern const char pl_engine_words_json[];

json_t *pl_engine_words(void)
{
    return json_loads(pl_engine_words_json, JSON_REJECT_DUPLICATES, NULL);
}

static bool is_in_report(const pl_result_matrix *matrix, const char *engine)
{
    for (int i = 0; i < matrix->column_count; ++i) {
        if (strcmp(matrix->columns[i].engine, engine) == 0) {
            return true;
        }
    }
    return false;
}

/* The engines of the file that are in the report. */
static json_t *engines_of(const pl_result_matrix *matrix, const json_t *words)
{
    size_t index;
    const json_t *name;
    json_t *listed = json_array();
    json_array_foreach(json_object_get(words, "engines"), index, name)
    {
        if (is_in_report(matrix, json_string_value(name))) {
            json_array_append_new(listed, json_string(json_string_value(name)));
        }
    }
    return listed;
}

static void add_rows(const json_t *words, const json_t *engines, pl_table *table)
{
    size_t index, column;
    const json_t *word, *engine;
    json_array_foreach(json_object_get(words, "words"), index, word)
    {
        const json_t *means = json_object_get(word, "means");
        pl_table_add(table, pl_json_get_text(word, "word"));
        json_array_foreach(engines, column, engine)
        {
            pl_table_add(table, pl_json_get_text(means, json_string_value(engine)));
            pl_table_style(table, "why", NULL);
        }
    }
}

void pl_engine_words_add(const pl_result_matrix *matrix, const pl_page *page)
{
    json_t *words = pl_engine_words();
    json_t *engines = engines_of(matrix, words);
    char columns[256] = "Word";
    size_t index, used = strlen(columns);
    const json_t *engine;
    json_array_foreach(engines, index, engine)
    {
        used += (size_t)snprintf(columns + used, sizeof columns - used, "|%s",
                                 json_string_value(engine));
    }
    if (json_array_size(engines) > 0) {
        pl_table table = {0};
        pl_table_columns(&table, columns);
        add_rows(words, engines, &table);
        pl_page_heading(page, "words", "What words mean in each engine");
        pl_page_paragraph(page, "",
                          "The same word is not the same thing in every engine. This is how the "
                          "scene's numbers and the options reach each of them, and what could not "
                          "be mapped.");
        pl_page_table(page, table, 0);
    }
    json_decref(engines);
    json_decref(words);
}
