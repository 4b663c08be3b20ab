// Transforms the corners of the triangles that are drawn over an image: the viewer's panel.
#version 450

layout(location = 0) in vec2 position; // pixels from the upper left corner
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 color; // display values

layout(push_constant) uniform Push
{
    vec2 clip_per_pixel; // 2 / size of the image in pixels
};

layout(location = 0) out vec2 atlas_uv;
layout(location = 1) out vec4 corner_color;

void main()
{
    gl_Position = vec4(position * clip_per_pixel - 1.0, 0.0, 1.0);
    atlas_uv = uv;
    corner_color = color;
}
