#include "page.h"

#include <stdlib.h>
#include <string.h>

/* The bundled page, with `place` where the data goes (page/CMakeLists.txt makes it). */
extern const char pl_page_html[];
static const char place[] = "<!--data-->";

void pl_page_open(pl_text_buffer *out)
{
    const char *at = strstr(pl_page_html, place);
    pl_text_add_bytes(out, pl_page_html, (size_t)(at - pl_page_html));
}

void pl_page_close(pl_text_buffer *out)
{
    pl_text_add(out, strstr(pl_page_html, place) + strlen(place));
}

/* Nothing in JSON but the inside of a string has a '<', which there may be written as \u003c. So no
 * text can end the element. */
void pl_page_add_text(pl_text_buffer *out, const char *id, const char *text, size_t length)
{
    pl_text_format(out, "<script type=\"application/json\" id=\"%s\">", id);
    for (size_t begin = 0; begin < length;) {
        const char *found = memchr(text + begin, '<', length - begin);
        const size_t end = found == NULL ? length : (size_t)(found - text);
        pl_text_add_bytes(out, text + begin, end - begin);
        pl_text_add(out, found == NULL ? "" : "\\u003c");
        begin = found == NULL ? length : end + 1;
    }
    pl_text_add(out, "</script>\n");
}

void pl_page_add(pl_text_buffer *out, const char *id, const json_t *json)
{
    char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(17));
    pl_page_add_text(out, id, text, strlen(text));
    free(text);
}

void pl_page_of_study(pl_text_buffer *out, const char *kind, json_t *study)
{
    json_t *data = json_pack("{s:s, s:O}", "kind", kind, "study", study);
    pl_page_open(out);
    pl_page_add(out, "data", data);
    pl_page_close(out);
    json_decref(data);
}
