#include "gltf_builder.h"

#include "scene/core/affine.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void append(char *text, size_t capacity, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void append(char *text, size_t capacity, const char *format, ...)
{
    size_t length = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    int added = vsnprintf(text + length, capacity - length, format, arguments);
    va_end(arguments);
    if (added < 0 || (size_t)added >= capacity - length)
        abort();
}

uint32_t builder_view(struct gltf_builder *builder, const void *data, size_t size,
                      const char *members)
{
    if (builder->size + size + 4 > sizeof builder->binary)
        abort();
    append(builder->views, sizeof builder->views,
           "%s{'buffer':0,'byteOffset':%zu,'byteLength':%zu%s%s}", builder->view_count ? "," : "",
           builder->size, size, *members ? "," : "", members);
    memcpy(builder->binary + builder->size, data, size);
    builder->size = (builder->size + size + 3) & ~(size_t)3;
    return builder->view_count++;
}

uint32_t builder_accessor(struct gltf_builder *builder, int code, const char *type, uint32_t count,
                          const void *data, size_t size)
{
    // Further members follow the type's name.
    int name = (int)strcspn(type, ",");
    uint32_t view = builder_view(builder, data, size, "");
    append(builder->accessors, sizeof builder->accessors,
           "%s{'bufferView':%u,'componentType':%d,'count':%u,'type':'%.*s'%s}",
           builder->accessor_count ? "," : "", view, code, count, name, type, type + name);
    return builder->accessor_count++;
}

struct bytes builder_glb(const struct gltf_builder *builder, const char *lists)
{
    static char json[16384];
    *json = '\0';
    append(json, sizeof json, "{'asset':{'version':'2.0'},%s", lists);
    if (builder->view_count > 0)
        append(json, sizeof json, ",'bufferViews':[%s],'buffers':[{'byteLength':%zu}]",
               builder->views, builder->size);
    if (builder->accessor_count > 0)
        append(json, sizeof json, ",'accessors':[%s]", builder->accessors);
    append(json, sizeof json, "}");
    return glb_bytes(json, builder->binary, builder->size);
}

bool builder_load(const struct gltf_builder *builder, const char *lists,
                  const struct gltf_load_params *params, struct scene *scene, struct err *err)
{
    struct bytes glb = builder_glb(builder, lists);
    struct gltf_load_params all = params ? *params : (struct gltf_load_params){0};
    all.source = (struct gltf_source){.path = "test.glb", .bytes = {glb.data, glb.size}};
    all.place = all.place ? all.place : AFFINE_IDENTITY;
    all.with_cameras = true;
    *scene = empty_scene("test.glb");
    *err = (struct err){0};
    bool ok = gltf_load_bytes(scene, &all, err);
    free(glb.data);
    return ok;
}
