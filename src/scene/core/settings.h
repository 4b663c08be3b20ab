// The settings of a render: everything except the scene. settings_default() sets the defaults; the
// scene file overrides them, and the command line overrides both.
#ifndef LAMPYRIS_SCENE_CORE_SETTINGS_H
#define LAMPYRIS_SCENE_CORE_SETTINGS_H

#include "base/field.h"
#include "image/tone.h"
#include "shared/methods.h"

#define SETTINGS_SIZE_MAX (UINT32_C(1) << 24)
#define SETTINGS_PIXELS_MAX (UINT64_C(1) << 31)
#define SETTINGS_SPP_MAX UINT32_MAX
#define SETTINGS_BOUNCES_MAX (UINT32_C(1) << 20)
#define SETTINGS_EXPOSURE_MAX 100 // stops; 2^100 is within single precision
#define SETTINGS_FILTER_RADIUS_MAX 16
#define SETTINGS_STRATA_MAX 16 // strata along one side of a pixel
#define SETTINGS_EXPONENT_MAX 1e6
#define SETTINGS_SPLIT_LOBES_MAX 4 // a sample then has 2^4 slots
#define SETTINGS_REAL_MAX 3.4e38
#define SETTINGS_LENGTH_MIN 1e-37

// settings_list.h lists and documents the members.
struct settings {
#define SETTING(ID, type, member, ...) type member;
#define SETTING_OF_FILE SETTING
#include "scene/core/settings_list.h"
    uint32_t exposure_is_auto; // 1: `exposure` is computed from the image, see image.h; else 0
};

enum setting_id {
#define SETTING(ID, ...) SETTING_##ID,
#define SETTING_OF_FILE SETTING
#include "scene/core/settings_list.h"
    SETTING_TOTAL
};
// Settings in the section "film" of scene files; the others are in "settings".
#define SETTINGS_FILM_FIRST SETTING_WIDTH
#define SETTINGS_FILM_LAST SETTING_TONE

struct setting {
    struct field field;
    const char *option;   // without dashes; NULL: for scene files only
    const char *group;    // group of the option in the help
    const char *help;     // sentences, with the unit
    const char *brief;    // one line for --help; NULL: only --help-all shows the option
    bool changes_samples; // false: only changes the number of samples, or the display of the film
    double fallback;      // the default
    // The meaning of the setting's word, or of its least number if it has no word; NULL: no special
    // meaning.
    const char *special;
    const char *argument; // placeholder of the number in the help
    // The label in the viewer's panel; NULL: not shown there.
    const char *label;
    const char *unit; // shown after the number
    double drag;      // change by dragging across the whole control; 0: derived from the range
    bool gap;         // the panel leaves a gap before the setting
    // The setting has an effect only while the setting `needs` has one of these values, one bit
    // each; 0: always.
    enum setting_id needs;
    uint32_t needs_values;
    bool needs_image; // has an effect only if the environment is an image
};

extern const struct setting settings_table[SETTING_TOTAL];

struct settings settings_default(void);
// Returns whether all members are bitwise equal.
bool settings_same(const struct settings *a, const struct settings *b);
bool setting_is_in_use(const struct setting *setting, const struct settings *settings,
                       bool has_image);
// Writes the range of a number, such as "From 0.01 to 1."; "" for choices and switches.
#define SETTING_RANGE_MAX 120
void setting_range(const struct setting *setting, char out[SETTING_RANGE_MAX]);
// Writes the default, such as "off (any distance)".
void setting_default_text(const struct setting *setting, char out[SETTING_RANGE_MAX]);

// Returns the integrator that a renderer has with these settings. INTEGRATOR_AUTO is
// INTEGRATOR_PATH, unless a job has made a choice and set it (job/choice.h).
uint32_t settings_integrator(const struct settings *settings);

// Returns the radius that was set, or else the filter's default.
float settings_filter_radius(const struct settings *settings);

// Returns whether samples are spread over the pixel. Otherwise all are at its centre.
bool settings_spread_over_pixel(const struct settings *settings);

// The names of choices, in the order of their values; each list ends with NULL. Scene files,
// options and reports use these names.
extern const char *const integrator_names[];
extern const char *const sampler_names[];
extern const char *const accumulation_names[];
extern const char *const halves_names[];
extern const char *const filter_names[];
extern const char *const pixel_sampling_names[];
extern const char *const environment_filter_names[];
extern const char *const environment_sampling_names[];
extern const char *const light_choice_names[];
extern const char *const mis_names[];
extern const char *const directions_names[];
extern const char *const roulette_names[];
extern const char *const normals_names[];
extern const char *const tone_names[];
extern const char *const camera_names[]; // names of the values of struct camera.kind

#endif
