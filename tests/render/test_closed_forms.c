// Tests scenes with radiance in closed form from the table of cases (src/check/case_list.h), with
// their numbers in docs/verification.md, B and C.
#include "form_trials.h"
#include "test.h"

TEST(light)
{
    forms_by_default(&check_light, 0);
}

TEST(light_validated)
{
    forms_validated(&check_light);
}

TEST(light_every_estimator_long)
{
    forms_by_every_estimator(&check_light, 0);
}

TEST(light_every_choice_long)
{
    forms_by_every_light_choice(&check_light, 50000);
}

TEST(media)
{
    forms_by_default(&check_media, 100000);
}

TEST(media_validated)
{
    forms_validated(&check_media);
}

TEST(media_every_estimator_long)
{
    forms_by_every_estimator(&check_media, 100000);
}

TEST(closed_rooms)
{
    forms_by_default(&check_rooms, 70000);
}

TEST(lights_over_a_floor)
{
    forms_by_default(&check_lamps, 72000);
}

TEST(grounds_without_end)
{
    forms_by_default(&check_grounds, 74000);
}

TEST(bodies_of_glass_and_fog)
{
    forms_by_default(&check_bodies, 76000);
}

TEST(shapes_validated)
{
    forms_validated(&check_rooms);
    forms_validated(&check_lamps);
    forms_validated(&check_grounds);
    forms_validated(&check_bodies);
}

TEST(shapes_every_estimator_long)
{
    forms_by_every_estimator(&check_rooms, 80000);
    forms_by_every_estimator(&check_lamps, 82000);
    forms_by_every_estimator(&check_grounds, 84000);
}

TEST(shapes_every_choice_long)
{
    forms_by_every_light_choice(&check_rooms, 90000);
    forms_by_every_light_choice(&check_lamps, 92000);
    forms_by_every_light_choice(&check_grounds, 94000);
}

TEST(fields)
{
    forms_by_default(&check_fields, 76000);
}

TEST(fields_validated)
{
    forms_validated(&check_fields);
}

TEST(fields_every_estimator_long)
{
    forms_by_every_estimator(&check_fields, 88000);
}

TEST(integrators)
{
    forms_by_default(&check_integrators, 200000);
}

TEST(integrators_validated)
{
    forms_validated(&check_integrators);
}

TEST(scales)
{
    forms_that_are_short(&check_scales, 0);
}

TEST(scales_every_estimator_long)
{
    forms_by_every_estimator(&check_scales, 0);
}

TEST(distances)
{
    forms_that_are_short(&check_distances, 1000);
}

TEST(distances_long)
{
    forms_by_default(&check_distances, 2000);
}

TEST(small_lamps)
{
    forms_by_default(&check_small_lamps, 3000);
}

TEST(small_lamps_every_choice_long)
{
    forms_by_every_light_choice(&check_small_lamps, 3000);
}

TEST(environments)
{
    forms_by_default(&check_environments, 4000);
}

TEST(environments_every_estimator_long)
{
    forms_by_every_estimator(&check_environments, 4000);
}

TEST(rooms_by_light_paths)
{
    forms_by_light_paths(&check_rooms, 120000, 15);
}

// Of the groups without forms here, this integrator refuses all: media in which lamps stand,
// fields, and lamps that are small for their distance from the origin.
TEST(light_paths_long)
{
    forms_by_light_paths(&check_light, 110000, 40);
    forms_by_light_paths(&check_lamps, 122000, 8);
    forms_by_light_paths(&check_media, 130000, 12);
    forms_by_light_paths(&check_scales, 134000, 9);
    forms_by_light_paths(&check_distances, 136000, 4);
    forms_by_light_paths(&check_environments, 140000, 9);
    forms_by_light_paths(&check_meshes, 142000, 4);
    forms_by_light_paths(&check_textures, 144000, 1);
}

TEST_MAIN(TEST_CASE(light), TEST_CASE(light_validated), TEST_CASE(light_every_estimator_long),
          TEST_CASE(light_every_choice_long), TEST_CASE(media), TEST_CASE(media_validated),
          TEST_CASE(media_every_estimator_long), TEST_CASE(closed_rooms),
          TEST_CASE(lights_over_a_floor), TEST_CASE(grounds_without_end),
          TEST_CASE(bodies_of_glass_and_fog), TEST_CASE(shapes_validated),
          TEST_CASE(shapes_every_estimator_long), TEST_CASE(shapes_every_choice_long),
          TEST_CASE(fields), TEST_CASE(fields_validated), TEST_CASE(fields_every_estimator_long),
          TEST_CASE(integrators), TEST_CASE(integrators_validated), TEST_CASE(scales),
          TEST_CASE(scales_every_estimator_long), TEST_CASE(distances), TEST_CASE(distances_long),
          TEST_CASE(small_lamps), TEST_CASE(small_lamps_every_choice_long), TEST_CASE(environments),
          TEST_CASE(environments_every_estimator_long), TEST_CASE(rooms_by_light_paths),
          TEST_CASE(light_paths_long))
