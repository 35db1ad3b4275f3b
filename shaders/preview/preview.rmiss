#version 460
// Nothing lies between the surface and the light: its light is added to the pixel.
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 contribution;

void main() { imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), vec4(contribution, 1.0)); }
