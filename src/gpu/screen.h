// Draws the display of a viewer: a rendered image, and triangles (the panel) over it. Both are
// drawn into a separate Vulkan image, so that the result is the same with and without a window.
// Needs gpu_params.graphics.
#ifndef LAMPYRIS_GPU_SCREEN_H
#define LAMPYRIS_GPU_SCREEN_H

#include "gpu/gpu.h"

// A vertex in Dear ImGui's layout. Positions are in pixels from the upper left. The lowest byte of
// a colour is red; alpha is not premultiplied. All colours and pixels are display values
// (sRGB-encoded).
struct gpu_vertex {
    float position[2];
    float uv[2]; // texture coordinates in the atlas, 0 to 1
    uint32_t color;
};

struct gpu_draw {
    uint32_t index_count, first_index, first_vertex;
    float clip[4]; // clipping rectangle: left, top, right, bottom, in pixels
};

struct gpu_drawing {
    const struct gpu_vertex *vertices;
    const uint16_t *indices; // corners of triangles, relative to a draw's first_vertex
    const struct gpu_draw *draws;
    uint32_t vertex_count, index_count, draw_count;
};

// The texture of all draws: white, with `coverage` as alpha.
struct gpu_atlas {
    const uint8_t *coverage; // width * height values, rows from the top
    uint32_t width, height;
};

struct gpu_image {
    VkImage handle;
    VkDeviceMemory memory;
    VkImageView view; // VK_NULL_HANDLE for images that are only copied
    uint64_t bytes;
};

// Creates an optimally tiled image with one layer and one level. Its content and layout are
// undefined.
bool gpu_image_create(struct gpu *gpu, const char *name, VkFormat format, uint32_t width,
                      uint32_t height, VkImageUsageFlags usage, struct gpu_image *out,
                      struct err *err);
void gpu_image_finish(struct gpu *gpu, struct gpu_image *image); // accepts {0}

struct gpu_screen {
    uint32_t width, height; // 0 before the first gpu_screen_resize
    // The format is VK_FORMAT_R8G8B8A8_UNORM; after gpu_screen_draw the layout is
    // TRANSFER_SRC_OPTIMAL. Transfers on the same queue may read the image: the next
    // gpu_screen_draw waits for them.
    struct gpu_image image;
    bool is_drawn; // false until the first gpu_screen_draw at the present size
    VkFramebuffer framebuffer;
    VkRenderPass render_pass;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout pipeline_layout;
    VkPipeline pipeline;
    struct gpu_image atlas;
    VkSampler sampler;
    VkDescriptorPool pool;
    VkDescriptorSet set;
    struct gpu_buffer vertices, indices; // mapped; replaced by larger ones when needed
    struct gpu_commands commands;
    double draw_ms; // device time of the last gpu_screen_draw; 0 without timestamps
};

// Creates a screen without an image; gpu_screen_resize creates the image.
bool gpu_screen_create(struct gpu *gpu, const struct gpu_atlas *atlas, struct gpu_screen *out,
                       struct err *err);
void gpu_screen_finish(struct gpu *gpu, struct gpu_screen *screen); // accepts NULL and {0}
// Replaces the image unless it has this size already. Width and height may be from 1 to the
// device's limit for images and framebuffers.
bool gpu_screen_resize(struct gpu *gpu, struct gpu_screen *screen, uint32_t width, uint32_t height,
                       struct err *err);
// Copies `pixels` into the image, draws the triangles of `drawing` (NULL: none) over them, and
// waits for the end. `pixels` has at least width * height words of RGBA8, rows from the top.
bool gpu_screen_draw(struct gpu *gpu, struct gpu_screen *screen, const struct gpu_buffer *pixels,
                     const struct gpu_drawing *drawing, struct err *err);
// Returns the pixels of the last gpu_screen_draw in `arena`: RGBA8, rows from the top.
bool gpu_screen_read(struct gpu *gpu, struct gpu_screen *screen, struct arena *arena,
                     uint8_t (**out)[4], struct err *err);

#endif
