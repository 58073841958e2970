/* SPDX-License-Identifier: MIT */
#include "tests/check.h"

#include "core/nearest_word.h"

#include <string.h>

static const char *const methods[] = {"trace",   "envmap",   "proxy",    "distance",
                                      "average", "cosine-r", "cosine-n", "angle"};
enum { method_count = sizeof methods / sizeof *methods };

static void one_slip_of_each_kind_finds_the_word(void **state)
{
    (void)state;
    assert_string_equal(ncr_nearest_word("distanc", method_count, methods), "distance");
    assert_string_equal(ncr_nearest_word("proxxy", method_count, methods), "proxy");
    assert_string_equal(ncr_nearest_word("trame", method_count, methods), "trace");
    assert_string_equal(ncr_nearest_word("nagle", method_count, methods), "angle");
}

static void a_swap_is_one_slip_not_two(void **state)
{
    (void)state;
    /* "ba" is two replacements from "ab" but two letters from "bacd": the swap must win */
    const char *words[] = {"bacd", "ab"};
    assert_string_equal(ncr_nearest_word("ba", 2, words), "ab");
}

static void case_and_underscores_count_nothing(void **state)
{
    (void)state;
    const char *words[] = {"cosine-s", "COSINE_N"};
    assert_string_equal(ncr_nearest_word("cosine-n", 2, words), "COSINE_N");
}

static void first_of_equals_wins_and_nothing_gives_null(void **state)
{
    (void)state;
    const char *words[] = {"bat", "cat", "rat"};
    assert_string_equal(ncr_nearest_word("hat", 3, words), "bat");
    assert_null(ncr_nearest_word("hat", 0, words));
    assert_string_equal(ncr_nearest_word("", 3, words), "bat");
}

static void over_long_words_are_compared_by_their_beginning(void **state)
{
    (void)state;
    char a[200], b[200];
    memset(a, 'a', sizeof a);
    memset(b, 'b', sizeof b);
    a[199] = b[199] = 0;
    const char *words[] = {b, a};
    assert_ptr_equal(ncr_nearest_word(a, 2, words), a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_slip_of_each_kind_finds_the_word),
        cmocka_unit_test(a_swap_is_one_slip_not_two),
        cmocka_unit_test(case_and_underscores_count_nothing),
        cmocka_unit_test(first_of_equals_wins_and_nothing_gives_null),
        cmocka_unit_test(over_long_words_are_compared_by_their_beginning),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
