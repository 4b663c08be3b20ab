// Selects the loader of a mesh file by the file's extension.
#include "base/file.h"
#include "scene/core/scene.h"

bool is_mesh_file(const char *path)
{
    return path_has_extension(path, "obj") || path_has_extension(path, "ply") ||
           path_has_extension(path, "stl");
}

const char *mesh_file_hint(const char *path)
{
    static const char *const of_blender[] = {"fbx",  "blend", "dae",  "3ds", "abc", "usd",
                                             "usda", "usdc",  "usdz", "x3d", "wrl"};
    static const char *const of_freecad[] = {"step", "stp", "iges", "igs", "fcstd"};
    for (size_t i = 0; i < sizeof of_blender / sizeof *of_blender; i++)
        if (path_has_extension(path, of_blender[i]))
            return "; Blender can export it as glTF";
    for (size_t i = 0; i < sizeof of_freecad / sizeof *of_freecad; i++)
        if (path_has_extension(path, of_freecad[i]))
            return "; FreeCAD can export it as glTF";
    return "";
}

bool load_mesh_by_extension(struct scene *scene, const char *path, uint32_t default_material,
                            bool allow_outside_paths, uint32_t *index, struct err *err)
{
    if (path_has_extension(path, "obj"))
        return load_obj(scene, path, default_material, allow_outside_paths, index, err);
    if (path_has_extension(path, "ply"))
        return load_ply(scene, path, default_material, index, err);
    return load_stl(scene, path, default_material, index, err);
}
