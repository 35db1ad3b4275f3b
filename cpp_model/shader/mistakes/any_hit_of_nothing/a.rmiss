#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 1) rayPayloadInEXT vec3 light;

void main() { imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), vec4(light, 1.0)); }
