/* Memory that ends ends the process. */
#include "base/arena.h"
#include "base/heap.h"
#include "base/sanitizer.h"
#include "check.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static void take_array(void)
{
    free(pl_heap_new(SIZE_MAX / 4, 8));
}

static void take_from_arena(void)
{
    pl_arena arena = {0};
    (void)pl_arena_take(&arena, SIZE_MAX / 4, 8);
}

static void take_text(void)
{
    pl_text_buffer text = {.failed = true};
    free(pl_text_take(&text));
}

static void test_without_memory_the_exit_code_is_3(void **state)
{
    (void)state;
    void (*const takes[])(void) = {take_array, take_from_arena, take_text};
#if PL_SANITIZER
    skip(); /* it ends the process itself */
#endif
    for (size_t i = 0; i < sizeof takes / sizeof *takes; ++i) {
        int ends[2], status = 0;
        char said[200] = "";
        assert_int_equal(pipe(ends), 0);
        const pid_t child = fork();
        if (child == 0) {
            dup2(ends[1], STDERR_FILENO);
            takes[i]();
            _exit(0);
        }
        assert_int_equal(waitpid(child, &status, 0), child);
        close(ends[1]);
        assert_true(read(ends[0], said, sizeof said - 1) > 0);
        close(ends[0]);
        assert_string_equal(said, pl_out_of_memory_message);
        assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 3);
    }
}

static void test_nothing_is_an_empty_text(void **state)
{
    (void)state;
    pl_text_buffer text = {0};
    char *taken = pl_text_take(&text);
    assert_string_equal(taken, "");
    free(taken);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_without_memory_the_exit_code_is_3),
                                       cmocka_unit_test(test_nothing_is_an_empty_text)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
