// Makes glTF files with materials, and tests the materials that are loaded from them.
#ifndef LAMPYRIS_TESTS_MATERIAL_FILE_H
#define LAMPYRIS_TESTS_MATERIAL_FILE_H

#include "gltf_fixture.h"

// The colours of two images of 2 x 2 pixels that the files may contain.
extern const uint8_t material_pictures[2][4];

// A file with one triangle per material. `lists` has further members of the document, each after a
// comma, or is NULL; the first %s in it is replaced by the URI of the first image, the next one by
// that of the second.
struct material_file {
    const char *materials;
    uint32_t count;
    const char *lists;
};

#define TWO_TEXTURES                                                                               \
    ",'textures':[{'source':0},{'source':1}],"                                                     \
    "'images':[{'uri':'%s'},{'uri':'%s'}]"

// The extension KHR_materials_NAME of a material.
#define EXTENSION(name, members) "'extensions':{'KHR_materials_" name "':{" members "}}"

// The result is to be freed by free().
char *material_json(const struct material_file *file);
// Loads a file whose buffer of 36 bytes, for the triangle, is added here.
bool load_material_json(struct scene *scene, const char *json, struct err *err);
// Loads the file. If that fails, records a failure, finishes the scene and returns false.
bool load_materials(struct scene *scene, const struct material_file *file);

// Makes a file with every material extension, an embedded image, and the three kinds of lights.
struct bytes material_seed(void);

bool near(float a, double b); // returns whether they differ by at most 1e-6
bool near3(const float *a, double x, double y, double z);

// Checks how a texture scales a parameter group of a material. "rgb-" means: the texel's colours
// scale the first three components, nothing the fourth. Upper case means the inverse, and "none"
// that there is no such texture, or more than one.
void check_scale(const struct scene *scene, uint32_t material, uint32_t group,
                 const char *expected);
// scale_of() returns the texture that scales a group of a material; NULL if there is none or more
// than one. image_of() returns its image, or an empty one.
const struct texture *scale_of(const struct scene *scene, uint32_t material, uint32_t group);
const struct texture_image *image_of(const struct scene *scene, uint32_t material, uint32_t group);

#endif
