/* Text that is folded to a window. */
#include "base/diagnostic.h"
#include "base/folding.h"
#include "check.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { TEXT_SIZE = 4000 };

/* Words of letters of one, two and three bytes, in lines with and without columns. */
static void make_text(check_random *random, char text[TEXT_SIZE])
{
    static const char *const parts[] = {"a", "b", "µ", "–", "_", ":", " ", "  ", "\n", "- "};
    text[0] = '\0';
    const int count = (int)check_uniform(random, 1, 400);
    for (int i = 0; i < count; ++i) {
        strcat(text, parts[(int)check_uniform(random, 0, i % 3 == 0 ? 10 : 6)]);
    }
}

static void without_blanks(const char *text, char *kept)
{
    for (; *text != '\0'; ++text) {
        if (*text != ' ' && *text != '\n') {
            *kept++ = *text;
        }
    }
    *kept = '\0';
}

static int widest_line(const char *text)
{
    int widest = 0;
    for (const char *line = text; *line != '\0';) {
        const size_t length = strcspn(line, "\n");
        char copy[TEXT_SIZE];
        snprintf(copy, sizeof copy, "%.*s", (int)length, line);
        widest = pl_text_width(copy) > widest ? pl_text_width(copy) : widest;
        line += length + (line[length] == '\n');
    }
    return widest;
}

static void check_folded(const char *text, int width, const char *expected)
{
    pl_text_buffer out = {0};
    pl_text_add_folded(&out, text, width);
    assert_string_equal(out.data, expected);
    pl_text_free(&out);
}

static void test_folded_lines_fit_and_lose_nothing(void **state)
{
    (void)state;
    check_random random = {7};
    for (int trial = 0; trial < 2000; ++trial) {
        char text[TEXT_SIZE], before[TEXT_SIZE], after[TEXT_SIZE];
        make_text(&random, text);
        const int width = (int)check_uniform(&random, 10, 200);
        pl_text_buffer out = {0};
        pl_text_add_folded(&out, text, width);
        assert_at_most(widest_line(out.data), width);
        without_blanks(text, before);
        without_blanks(out.data, after);
        assert_string_equal(after, before);
        if (widest_line(text) <= width) {
            assert_string_equal(out.data, text);
        }
        pl_text_free(&out);
    }
}

static void test_words_stay_whole_where_they_fit(void **state)
{
    (void)state;
    check_folded("one two three four", 9, "one two\nthree\nfour");
    check_folded("penetration_max:0.25 is µµµµµµµµµµµµ", 11,
                 "penetration\n_max:0.25\nis\nµµµµµµµµµµµ\nµ");
    check_folded("rest_position_error", 12, "rest_\nposition_\nerror");
}

static void test_further_lines_stand_below_their_column(void **state)
{
    (void)state;
    check_folded("  name    what it means\n", 18, "  name    what it\n    means\n");
    check_folded("  name  what it means\n", 20, "  name  what it\n        means\n");
    check_folded("- an item of a list\n", 11, "- an item\n  of a list\n");
    check_folded("  indented by two\n", 12, "  indented\n    by two\n");
    check_folded("a paragraph of words\n", 12, "a paragraph\nof words\n");
}

static void test_control_characters_do_not_reach_the_terminal(void **state)
{
    (void)state;
    check_folded("a\033[2Jb", 40, "a?[2Jb");
    check_folded("a\033b c", 3, "a?b\nc");
    static const char *const bad[] = {"\001",
                                      "\177",
                                      "\302\233",
                                      "\342\200\252",
                                      "\342\200\256",
                                      "\342\201\246",
                                      "\342\201\251",
                                      "\342\200\216",
                                      "\342\200\217",
                                      "\330\234",
                                      "\342\200\250",
                                      "\342\200\251",
                                      "\377",
                                      "\303",
                                      "\300\257",
                                      "\355\240\200",
                                      "\364\220\200\200"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        char text[32], quoted[PL_QUOTED_SIZE];
        pl_error error;
        snprintf(text, sizeof text, "a%sb", bad[i]);
        check_folded(text, 40, "a?b");
        assert_int_equal(pl_text_width(text), 3);
        pl_fail(&error, PL_FAILED, "%s", text);
        assert_string_equal(error.message, "a?b");
        assert_string_equal(pl_quoted(text, quoted), "\"a?b\"");
    }
    check_folded("\303\244 \342\202\254 \360\237\230\200 \302\240", 40,
                 "\303\244 \342\202\254 \360\237\230\200 \302\240");
}

/* Columns as of East Asian Width (Unicode Standard Annex 11), by hand. */
static void test_widths_are_columns_of_a_terminal(void **state)
{
    (void)state;
    assert_int_equal(pl_text_width("wall"), 4);
    assert_int_equal(pl_text_width("中文"), 4);
    assert_int_equal(pl_text_width("e\u0301t"), 2); /* a combining accent */
    assert_int_equal(pl_text_width("😀"), 2);
    assert_int_equal(pl_text_width("\xff\xe4"), 2); /* no UTF-8: two '?' */
    assert_int_equal((int)pl_text_fitting("a中文", 4), 4);
    assert_int_equal((int)pl_text_fitting("e\u0301t", 1), 3);
}

static void test_no_line_breaks_a_character(void **state)
{
    (void)state;
    check_folded("中文中文", 5, "中文\n中文");
    check_folded("aae\u0301e\u0301e\u0301", 3, "aae\u0301\ne\u0301e\u0301");
    check_folded("中文", 1, "中\n文"); /* one fits no line, and is not lost */
    check_folded("name  中文 is two words\n", 16, "name  中文 is\n      two words\n");
}

/* A terminal of `columns`, or a file where it is less than 0. */
static int width_on(int columns, const char *environment)
{
    FILE *out = NULL;
    int master = -1;
    if (columns < 0) {
        out = tmpfile();
    } else {
        master = posix_openpt(O_RDWR | O_NOCTTY);
        assert_true(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
        const int slave = open(ptsname(master), O_RDWR | O_NOCTTY);
        const struct winsize size = {.ws_row = 24, .ws_col = (unsigned short)columns};
        assert_true(slave >= 0 && ioctl(slave, TIOCSWINSZ, &size) == 0);
        out = fdopen(slave, "w");
    }
    assert_non_null(out);
    if (environment == NULL) {
        unsetenv("COLUMNS");
    } else {
        setenv("COLUMNS", environment, 1);
    }
    const int width = pl_window_width(out);
    assert_true(pl_window_is_known(out) == (columns >= 0 || environment != NULL));
    fclose(out);
    if (master >= 0) {
        close(master);
    }
    return width;
}

static void test_window_comes_before_columns_before_default(void **state)
{
    (void)state;
    assert_int_equal(width_on(93, "150"), 93);
    assert_int_equal(width_on(0, "150"), 150);
    assert_int_equal(width_on(0, NULL), 80);
    assert_int_equal(width_on(0, "many"), 80);
    assert_int_equal(width_on(-1, "66"), 66);
    assert_int_equal(width_on(-1, "-5"), PL_PIPE_WIDTH);
    assert_int_equal(width_on(-1, NULL), PL_PIPE_WIDTH);
    assert_int_equal(width_on(3, NULL), PL_LEAST_WINDOW);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_folded_lines_fit_and_lose_nothing),
        cmocka_unit_test(test_widths_are_columns_of_a_terminal),
        cmocka_unit_test(test_no_line_breaks_a_character),
        cmocka_unit_test(test_words_stay_whole_where_they_fit),
        cmocka_unit_test(test_further_lines_stand_below_their_column),
        cmocka_unit_test(test_control_characters_do_not_reach_the_terminal),
        cmocka_unit_test(test_window_comes_before_columns_before_default),
    };
    return cmocka_run_group_tests_name("folding", tests, NULL, NULL);
}
