#include "scene/gltf/draco_mesh.h"

#include <cstdio>
#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>
#include <draco/mesh/mesh.h>
#include <exception>
#include <memory>

struct draco_mesh {
    std::unique_ptr<draco::Mesh> mesh;
};

struct draco_mesh *draco_mesh_open(const void *data, size_t size, char *message,
                                   size_t message_size)
{
    message[0] = '\0';
    try {
        draco::DecoderBuffer buffer;
        draco::Decoder decoder;
        buffer.Init(static_cast<const char *>(data), size);
        auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
        if (decoded.ok())
            return new draco_mesh{std::move(decoded).value()};
        snprintf(message, message_size, "%s", decoded.status().error_msg());
    } catch (const std::exception &) {
        // The library allocates as much memory as the data ask for, so it may run out of memory.
    }
    return nullptr;
}

void draco_mesh_close(struct draco_mesh *mesh)
{
    delete mesh;
}

uint32_t draco_mesh_points(const struct draco_mesh *mesh)
{
    return mesh->mesh->num_points();
}

uint32_t draco_mesh_triangles(const struct draco_mesh *mesh)
{
    return mesh->mesh->num_faces();
}

template <typename T>
static bool read(const draco::PointAttribute *attribute, uint32_t points, uint32_t components,
                 T *out)
{
    for (uint32_t i = 0; i < points; i++) {
        const auto at = attribute->mapped_index(draco::PointIndex(i));
        if (!attribute->ConvertValue<T>(at, static_cast<int8_t>(components),
                                        out + static_cast<size_t>(i) * components))
            return false;
    }
    return true;
}

bool draco_mesh_read(const struct draco_mesh *mesh, uint32_t id, enum draco_type type,
                     uint32_t components, void *out)
{
    const draco::PointAttribute *attribute = mesh->mesh->GetAttributeByUniqueId(id);
    const uint32_t points = mesh->mesh->num_points();
    if (!attribute)
        return false;
    switch (type) {
    case DRACO_I8:
        return read(attribute, points, components, static_cast<int8_t *>(out));
    case DRACO_U8:
        return read(attribute, points, components, static_cast<uint8_t *>(out));
    case DRACO_I16:
        return read(attribute, points, components, static_cast<int16_t *>(out));
    case DRACO_U16:
        return read(attribute, points, components, static_cast<uint16_t *>(out));
    case DRACO_U32:
        return read(attribute, points, components, static_cast<uint32_t *>(out));
    case DRACO_F32:
        return read(attribute, points, components, static_cast<float *>(out));
    }
    return false;
}

void draco_mesh_read_triangles(const struct draco_mesh *mesh, uint32_t (*out)[3])
{
    for (uint32_t i = 0; i < mesh->mesh->num_faces(); i++)
        for (uint32_t c = 0; c < 3; c++)
            out[i][c] = mesh->mesh->face(draco::FaceIndex(i))[c].value();
}
