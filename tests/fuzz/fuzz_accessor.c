// Fuzz target for decoding glTF accessors. The first bytes choose the fields and the use of an
// accessor, the others are its buffer, so no byte is spent on syntax.
#include "gltf_fixture.h"

#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

// The bytes of the input in their order. The buffer follows them.
enum { COMPONENT, TYPE, FLAGS, COUNT, STRIDE, OFFSET, VIEW_OFFSET, USE, SPARSE_COUNT, HEADER };
enum { NORMALIZED = 1, SPARSE = 2, WITH_STRIDE = 4, WITHOUT_VIEW = 8 };

static void write_json(const uint8_t *in, size_t buffer_size, char *out, size_t out_size)
{
    // The last value of each list is invalid.
    static const int components[] = {5120, 5121, 5122, 5123, 5125, 5126, 5124};
    static const char *types[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4", "VEC5"};
    static const char *uses[] = {"'attributes':{'POSITION':1}",
                                 "'attributes':{'POSITION':0,'NORMAL':1}",
                                 "'attributes':{'POSITION':0,'TANGENT':1}",
                                 "'attributes':{'POSITION':0,'TEXCOORD_0':1}",
                                 "'attributes':{'POSITION':0,'COLOR_0':1}",
                                 "'attributes':{'POSITION':0},'indices':1",
                                 "'attributes':{'POSITION':0},'targets':[{'POSITION':1}]"};
    int component = components[in[COMPONENT] % (sizeof components / sizeof components[0])];
    char view[48] = "", stride[32] = "", sparse[256] = "";
    if (!(in[FLAGS] & WITHOUT_VIEW))
        snprintf(view, sizeof view, "'bufferView':0,'byteOffset':%d,", in[OFFSET]);
    if (in[FLAGS] & WITH_STRIDE)
        snprintf(stride, sizeof stride, ",'byteStride':%d", in[STRIDE]);
    if (in[FLAGS] & SPARSE)
        snprintf(sparse, sizeof sparse,
                 ",'sparse':{'count':%d,'indices':{'bufferView':1,'componentType':%d},"
                 "'values':{'bufferView':1,'byteOffset':%d}}",
                 in[SPARSE_COUNT], in[STRIDE] & 1 ? 5121 : 5123, in[STRIDE] & ~3);
    size_t offset = in[VIEW_OFFSET];
    size_t view_size = buffer_size > offset ? buffer_size - offset : 1;
    snprintf(out, out_size,
             "{'asset':{'version':'2.0'},'extensionsUsed':['KHR_mesh_quantization'],"
             "'nodes':[{'mesh':0}],'meshes':[{'primitives':[{%s}]}],"
             "'accessors':[{'componentType':5126,'count':%d,'type':'VEC3'},{%s"
             "'componentType':%d,'normalized':%s,'count':%d,'type':'%s'%s}],"
             "'bufferViews':[{'buffer':0,'byteOffset':%zu,'byteLength':%zu%s},"
             "{'buffer':0,'byteLength':%zu}],'buffers':[{'byteLength':%zu}]}",
             uses[in[USE] % (sizeof uses / sizeof uses[0])], in[COUNT], view, component,
             in[FLAGS] & NORMALIZED ? "true" : "false", in[COUNT],
             types[in[TYPE] % (sizeof types / sizeof types[0])], sparse, offset, view_size, stride,
             buffer_size, buffer_size);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size <= HEADER)
        return 0;
    char json[2048];
    struct err err = {0};
    write_json(data, size - HEADER, json, sizeof json);
    struct scene scene = empty_scene("/nonexistent/fuzz.glb");
    if (load_glb(&scene, json, data + HEADER, size - HEADER, &err) && scene_objection(&scene)) {
        fprintf(stderr, "%s\n", scene_objection(&scene));
        abort();
    }
    scene_finish(&scene);
    return 0;
}
