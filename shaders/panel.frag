// Computes the colour of the panel's triangles; its opacity is multiplied by the coverage in the
// atlas.
#version 450

layout(location = 0) in vec2 atlas_uv;
layout(location = 1) in vec4 corner_color;

layout(set = 0, binding = 0) uniform sampler2D atlas;

layout(location = 0) out vec4 pixel; // alpha not premultiplied

void main()
{
    pixel = vec4(corner_color.rgb, corner_color.a * texture(atlas, atlas_uv).r);
}
