// expect: hit attributes
#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 color;
hitAttributeEXT mat3 frame;  // here

void main() {
  imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), vec4(frame * color, 1.0));
}
