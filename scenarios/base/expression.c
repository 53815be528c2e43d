/* Recursive descent by the grammar in the header. */
#include "expression.h"

#include "number.h"
#include "trigonometry.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST_NESTED = 32, MOST_NUMBERS = 64 };

typedef struct parser {
    const char *text, *at;
    pl_named_number *numbers;
    int count, depth;
    pl_diagnostic *diagnostic;
} parser;

static bool parse_sum(parser *p, double *value);

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* The length of the name at the beginning of a text; 0 where there is none. */
static size_t name_length(const char *text)
{
    size_t length = 0;
    while (is_letter(text[length]) || (length > 0 && is_digit(text[length]))) {
        ++length;
    }
    return length;
}

/* ---- Functions ---- */

/* The library's series are of angles from 0. */
static double sine(double angle)
{
    return angle < 0 ? -pl_sine_of_any(-angle) : pl_sine_of_any(angle);
}

static double cosine(double angle)
{
    return pl_cosine_of_any(fabs(angle));
}

static double tangent(double angle)
{
    return sine(angle) / cosine(angle);
}

static const struct {
    const char *name;
    double (*function)(double);
    double least, most; /* of the argument */
    const char *expected;
} functions[] = {{"sqrt", sqrt, 0, (double)INFINITY, "a number of at least 0"},
                 {"sin", sine, -1e6, 1e6, "an angle from -1e6 to 1e6 rad"},
                 {"cos", cosine, -1e6, 1e6, "an angle from -1e6 to 1e6 rad"},
                 {"tan", tangent, -1e6, 1e6, "an angle from -1e6 to 1e6 rad"}};
enum { FUNCTION_COUNT = sizeof functions / sizeof functions[0] };

static int find_function(const char *name, size_t length)
{
    for (int i = 0; i < FUNCTION_COUNT; ++i) {
        if (strlen(functions[i].name) == length && memcmp(functions[i].name, name, length) == 0) {
            return i;
        }
    }
    return -1;
}

static bool is_pi(const char *name, size_t length)
{
    return length == 2 && memcmp(name, "pi", 2) == 0;
}

bool pl_expression_may_name(const char *name)
{
    const size_t length = strlen(name);
    return length > 0 && name_length(name) == length && find_function(name, length) < 0 &&
           !is_pi(name, length);
}

/* ---- Faults ---- */

/* Reports `expected`, and what stands at a place of the text. */
static bool fail_at(parser *p, const char *expected, const char *found, const char *place)
{
    char quoted[PL_QUOTED_SIZE];
    return pl_diagnose(p->diagnostic, "expected %s, found %s at character %d of %s", expected,
                       found, (int)(place - p->text) + 1, pl_quoted(p->text, quoted));
}

/* Reports what stands where the parser is. */
static bool fail_here(parser *p, const char *expected)
{
    const char c[4] = {'\'', *p->at, '\'', '\0'};
    return fail_at(p, expected, *p->at == '\0' ? "the end" : c, p->at);
}

static bool fail_unknown(parser *p, const char *name, size_t length)
{
    char word[PL_NAME_SIZE], quoted[PL_QUOTED_SIZE];
    const char *names[MOST_NUMBERS];
    int count = 0;
    for (; count < p->count && count < MOST_NUMBERS; ++count) {
        names[count] = p->numbers[count].name;
    }
    snprintf(word, sizeof word, "%.*s", (int)length, name);
    const char *nearest = pl_nearest_name(word, names, count);
    fail_at(p, count == 0 ? "a number; the scene has no parameters" : "a number or a parameter",
            pl_quoted(word, quoted), name);
    if (nearest != NULL) {
        const size_t used = strlen(p->diagnostic->text);
        snprintf(p->diagnostic->text + used, sizeof p->diagnostic->text - used,
                 "; did you mean \"%s\"?", nearest);
    }
    return false;
}

/* The result of an operation, whose sign or name stands at `place`. */
static bool keep(parser *p, double result, const char *place, double *value)
{
    *value = result;
    return isfinite(result) || fail_at(p, "a finite result", "none", place);
}

/* ---- Grammar ---- */

/* The next character that is no blank. */
static char next(parser *p)
{
    while (*p->at == ' ') {
        ++p->at;
    }
    return *p->at;
}

static bool parse_number(parser *p, double *value)
{
    const char *begin = p->at;
    while (is_digit(*p->at) || *p->at == '.') {
        ++p->at;
    }
    if (*p->at == 'e' || *p->at == 'E') {
        p->at += p->at[1] == '-' || p->at[1] == '+' ? 2 : 1;
        while (is_digit(*p->at)) {
            ++p->at;
        }
    }
    return pl_decimal(begin, (size_t)(p->at - begin), value) ||
           fail_at(p, "a finite number", "another", begin);
}

/* A sum in parentheses. */
static bool parse_group(parser *p, double *value)
{
    if (next(p) != '(') {
        return fail_here(p, "'('");
    }
    ++p->at;
    if (!parse_sum(p, value)) {
        return false;
    }
    if (next(p) != ')') {
        return fail_here(p, "an operator or ')'");
    }
    ++p->at;
    return true;
}

static bool parse_name(parser *p, double *value)
{
    const char *name = p->at;
    const size_t length = name_length(name);
    const int function = find_function(name, length);
    p->at += length;
    if (function >= 0) {
        double argument = 0;
        if (!parse_group(p, &argument)) {
            return false;
        }
        if (!(argument >= functions[function].least && argument <= functions[function].most)) {
            char number[PL_NUMBER_SIZE];
            return fail_at(p, functions[function].expected, pl_number_text(argument, number), name);
        }
        return keep(p, functions[function].function(argument), name, value);
    }
    if (is_pi(name, length)) {
        *value = 3.141592653589793;
        return true;
    }
    for (int i = 0; i < p->count; ++i) {
        if (strlen(p->numbers[i].name) == length && memcmp(p->numbers[i].name, name, length) == 0) {
            p->numbers[i].used = true;
            *value = p->numbers[i].value;
            return true;
        }
    }
    return fail_unknown(p, name, length);
}

static bool parse_factor(parser *p, double *value)
{
    bool right = false;
    const char c = next(p);
    if (++p->depth > MOST_NESTED) {
        return fail_at(p, "at most 32 nested parts", "more", p->at);
    }
    if (c == '-') {
        ++p->at;
        right = parse_factor(p, value);
        *value = -*value;
    } else if (c == '(') {
        right = parse_group(p, value);
    } else if (is_digit(c)) {
        right = parse_number(p, value);
    } else if (is_letter(c)) {
        right = parse_name(p, value);
    } else {
        right = fail_here(p, "a number, a name, '-' or '('");
    }
    --p->depth;
    return right;
}

static bool parse_product(parser *p, double *value)
{
    double factor = 0;
    bool right = parse_factor(p, value);
    while (right && (next(p) == '*' || *p->at == '/')) {
        const char *sign = p->at++;
        right = parse_factor(p, &factor);
        if (right && *sign == '/' && factor == 0) {
            return fail_at(p, "a divisor other than 0", "0", sign);
        }
        right = right && keep(p, *sign == '*' ? *value * factor : *value / factor, sign, value);
    }
    return right;
}

static bool parse_sum(parser *p, double *value)
{
    double product = 0;
    bool right = parse_product(p, value);
    while (right && (next(p) == '+' || *p->at == '-')) {
        const char *sign = p->at++;
        right = parse_product(p, &product) &&
                keep(p, *sign == '+' ? *value + product : *value - product, sign, value);
    }
    return right;
}

bool pl_expression_value(const char *text, pl_named_number *numbers, int count, double *value,
                         pl_diagnostic *diagnostic)
{
    parser p = {
        .text = text, .at = text, .numbers = numbers, .count = count, .diagnostic = diagnostic};
    *value = 0;
    if (!parse_sum(&p, value)) {
        return false;
    }
    return next(&p) == '\0' || fail_here(&p, "an operator or the end");
}
