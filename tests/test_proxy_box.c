/* SPDX-License-Identifier: MIT */
#include "check.h"

#include "shading/proxy_box_internal.h"

enum { count = 4000 };

/* Random directions with the inverse distance of a given box (sides as inverse distances). */
static void look_at_box(const float box[6], ncr_proxy_sight *sights, check_random *r)
{
    for (int k = 0; k < count; k++) {
        ncr_proxy_sight *s = &sights[k];
        const double z = check_uniform(r, -1, 1), angle = check_uniform(r, 0, 6.283185307179586);
        s->d[0] = (float)(sqrt(1 - z * z) * cos(angle));
        s->d[1] = (float)(sqrt(1 - z * z) * sin(angle));
        s->d[2] = (float)z;
        s->weight = 1;
        s->near = 0;
        for (int axis = 0; axis < 3; axis++)
            s->near = fmaxf(s->near, fabsf(s->d[axis]) * box[2 * axis + (s->d[axis] < 0)]);
    }
}

static void a_room_that_is_a_box_is_found(void **state)
{
    (void)state;
    static ncr_proxy_sight sights[count];
    const float box[6] = {0.25f, 0.5f, 0.3f, 0.2f, 0.6f, 1.0f};
    float side[6];
    check_random r = {.seed = 11};
    look_at_box(box, sights, &r);
    const double left = ncr_proxy_box_fit(count, sights, side);
    for (int k = 0; k < 6; k++)
        CHECK(fabsf(side[k] - box[k]) < 2e-3f, "side %d: %g, not %g", k, (double)side[k],
              (double)box[k]);
    CHECK(left < 1e-3, "mean deviation %g", left);
}

static void open_sides_stay_open(void **state)
{
    (void)state;
    static ncr_proxy_sight sights[count];
    const float box[6] = {0, 0, 0, 0, 0, 1.0f}; /* a floor under an open sky */
    float side[6];
    check_random r = {.seed = 12};
    look_at_box(box, sights, &r);
    ncr_proxy_box_fit(count, sights, side);
    for (int k = 0; k < 5; k++)
        assert_true(side[k] < 2e-3f);
    CHECK_NEAR(side[5], 1, 2e-3);
}

static void a_few_cups_do_not_move_a_wall(void **state)
{
    (void)state;
    static ncr_proxy_sight sights[count];
    const float box[6] = {0.25f, 0.25f, 0.25f, 0.25f, 0.25f, 1.0f};
    float side[6];
    check_random r = {.seed = 13};
    look_at_box(box, sights, &r);
    for (int k = 0; k < count; k += 20)
        sights[k].near = 2;
    ncr_proxy_box_fit(count, sights, side);
    for (int k = 0; k < 5; k++)
        CHECK_NEAR(side[k], 0.25, 5e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_room_that_is_a_box_is_found),
        cmocka_unit_test(open_sides_stay_open),
        cmocka_unit_test(a_few_cups_do_not_move_a_wall),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
