// The display of a viewer: an image, with triangles drawn over it (a panel). It is drawn into an
// image of our own, so that it is the same with and without a window. Needs gpu_params.graphics.
#ifndef LAMPYRIS_GPU_SCREEN_H
#define LAMPYRIS_GPU_SCREEN_H

#include "gpu/gpu.h"

// A vertex in Dear ImGui's layout. Positions are in pixels from the upper left; colours have red in
// the lowest byte, and alpha is not premultiplied. All colours and pixels are display values
// (sRGB-encoded).
struct gpu_vertex {
    float position[2];
    float uv[2]; // in the atlas
    uint32_t color;
};

struct gpu_draw {
    uint32_t index_count, first_index, first_vertex;
    float clip[4]; // left, top, right, bottom, pixels
};

struct gpu_drawing {
    const struct gpu_vertex *vertices;
    const uint16_t *indices; // corners of triangles, relative to each draw's first_vertex
    const struct gpu_draw *draws;
    uint32_t vertex_count, index_count, draw_count;
};

// The image from which all draws take their texels: coverage, multiplied by white.
struct gpu_atlas {
    const uint8_t *coverage; // width * height, rows from the top
    uint32_t width, height;
};

struct gpu_image {
    VkImage handle;
    VkDeviceMemory memory;
    VkImageView view; // VK_NULL_HANDLE of images that are only copied
    uint64_t bytes;
};

// Creates an image of one layer and level, optimally tiled, with undefined content and layout.
bool gpu_image_create(struct gpu *gpu, const char *name, VkFormat format, uint32_t width,
                      uint32_t height, VkImageUsageFlags usage, struct gpu_image *out,
                      struct err *err);
void gpu_image_finish(struct gpu *gpu, struct gpu_image *image); // accepts {0}

struct gpu_screen {
    uint32_t width, height; // 0 before the first gpu_screen_resize
    // VK_FORMAT_R8G8B8A8_UNORM; after gpu_screen_draw in TRANSFER_SRC_OPTIMAL. Transfers of the
    // same queue may read it: the next drawing waits for them.
    struct gpu_image image;
    bool is_drawn; // since the last change of size
    VkFramebuffer framebuffer;
    VkRenderPass render_pass;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout pipeline_layout;
    VkPipeline pipeline;
    struct gpu_image atlas;
    VkSampler sampler;
    VkDescriptorPool pool;
    VkDescriptorSet set;
    struct gpu_buffer vertices, indices; // mapped, grown as need be
    struct gpu_commands commands;
    double draw_ms; // time of the last gpu_screen_draw on the device; 0 without timestamps
};

// There is no image until gpu_screen_resize.
bool gpu_screen_create(struct gpu *gpu, const struct gpu_atlas *atlas, struct gpu_screen *out,
                       struct err *err);
void gpu_screen_finish(struct gpu *gpu, struct gpu_screen *screen); // accepts NULL and {0}
// Does nothing if the size is the same. Width and height may be from 1 to the device's limits of
// images and framebuffers.
bool gpu_screen_resize(struct gpu *gpu, struct gpu_screen *screen, uint32_t width, uint32_t height,
                       struct err *err);
// Copies `pixels`, RGBA8 in rows from the top, width * height words at least, draws over it, and
// waits until it is done. drawing: NULL for none.
bool gpu_screen_draw(struct gpu *gpu, struct gpu_screen *screen, const struct gpu_buffer *pixels,
                     const struct gpu_drawing *drawing, struct err *err);
// Reads the last drawing: RGBA8, rows from the top, in `arena`.
bool gpu_screen_read(struct gpu *gpu, struct gpu_screen *screen, struct arena *arena,
                     uint8_t (**out)[4], struct err *err);

#endif
