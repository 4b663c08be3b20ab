#include "cli/tuned.h"

#include "report/json_out.h"
#include "report/text_out.h"
#include <stdio.h>

void tuned_load(struct options *options, struct tune_cache *cache)
{
    const struct command *command = options->command;
    bool all_given = options->wave && options->workgroup;
    if (!command || options->help || !option_belongs(&option_table[OPTION_TUNING], command) ||
        !options->tuning || options->tune || all_given)
        return;
    tune_cache_load(cache);
    options->tune_cache = cache;
}

struct tuned tuned_sizes(const struct options *options, const struct gpu *gpu)
{
    struct tuned tuned = {0};
    if (options->tune_cache)
        tuned = tune_cache_find(options->tune_cache, gpu);
    if (options->wave)
        tuned.wave = 0;
    if (options->workgroup)
        tuned.workgroup = 0;
    return tuned;
}

json_t *tuned_json(const struct options *options, const struct gpu *gpu)
{
    struct tuned tuned = tuned_sizes(options, gpu);
    if (!tuned.wave && !tuned.workgroup)
        return json_null();
    return json_pack("{s:o, s:o, s:o}", "wave", tuned_size_json(tuned.wave), "workgroup",
                     tuned_size_json(tuned.workgroup), "file",
                     json_words(options->tune_cache->path));
}

void tuned_print(const struct options *options, const struct gpu *gpu)
{
    struct tuned tuned = tuned_sizes(options, gpu);
    if (!tuned.wave && !tuned.workgroup)
        return;
    printf("tuned    ");
    if (tuned.wave)
        printf(" waves of %u paths,", tuned.wave);
    if (tuned.workgroup)
        printf(" workgroups of %u threads,", tuned.workgroup);
    print_line(" by ", options->tune_cache->path);
}
