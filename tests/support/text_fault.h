/* Faults in the text of a file: a good text changed at one place, where an @, which is taken out,
 * marks what is wrong. */
#ifndef PLUMB_TEST_TEXT_FAULT_H
#define PLUMB_TEST_TEXT_FAULT_H

typedef struct text_fault {
    const char *from, *to; /* the first `from` becomes `to`, which holds the @ */
    const char *path;
    const char *part; /* of the message behind the path */
} text_fault;

/* The text with the first `from` replaced; without one, the test fails. The caller frees it. */
char *text_with(const char *text, const char *from, const char *to);

/* Takes the @ out of `text` and counts characters up to it. */
void take_mark(char *text, int *line, int *column);

#endif
