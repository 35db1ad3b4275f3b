#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT float weight;
hitAttributeEXT RaypoolHit hit;

void main() {
  vec3 color = vec3(1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics);
  imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), vec4(color, 1.0));
}
