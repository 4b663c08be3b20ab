// glTF files of materials, and what to look for in what they become.
#ifndef LAMPYRIS_TESTS_MATERIAL_FILE_H
#define LAMPYRIS_TESTS_MATERIAL_FILE_H

#include "gltf_fixture.h"

// The colours of two pictures of 2 x 2 pixels that the files may carry.
extern const uint8_t material_pictures[2][4];

// A file of one triangle a material. `lists` are the document's further members, each with a comma
// before it, or NULL; the first %s in them is the URI of the first picture, the next of the second.
struct material_file {
    const char *materials;
    uint32_t count;
    const char *lists;
};

#define TWO_TEXTURES                                                                               \
    ",'textures':[{'source':0},{'source':1}],"                                                     \
    "'images':[{'uri':'%s'},{'uri':'%s'}]"

// A material's extension KHR_materials_NAME.
#define EXTENSION(name, members) "'extensions':{'KHR_materials_" name "':{" members "}}"

// free() it.
char *material_json(const struct material_file *file);
// Without a buffer of 36 bytes nothing loads: that of the triangle.
bool load_material_json(struct scene *scene, const char *json, struct err *err);
// Loads the file; records a failure, finishes the scene and returns false where that fails.
bool load_materials(struct scene *scene, const struct material_file *file);

// A file with every extension of materials, an image inside, and the three kinds of lights.
struct bytes material_seed(void);

bool near(float a, double b); // within 1e-6
bool near3(const float *a, double x, double y, double z);

// That a group of a material is scaled like this: "rgb-" is the texel's colours and nothing for the
// fourth; upper case for the inverse; "none" where there is no such texture, or two.
void check_scale(const struct scene *scene, uint32_t material, uint32_t group,
                 const char *expected);
// The texture of a material that scales a group; NULL: none, or two. And its image, or an empty
// one.
const struct texture *scale_of(const struct scene *scene, uint32_t material, uint32_t group);
const struct texture_image *image_of(const struct scene *scene, uint32_t material, uint32_t group);

#endif
