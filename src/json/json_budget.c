// A file of its own: the C library, which must not change what its caller's jansson does, does not
// contain it.
#include "json/json_parse.h"

void json_use_budget(void)
{
    json_set_alloc_funcs(json_allocate, json_deallocate);
}
