// This function has a file of its own so that the C library, which must not change its caller's
// jansson, can be built without it.
#include "json/json_parse.h"

void json_use_budget(void)
{
    json_set_alloc_funcs(json_allocate, json_deallocate);
}
