#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT float weight;
hitAttributeEXT RaypoolHit hit;

void main() {
  vec3 normal = raypool_normal(gl_PrimitiveID, hit.barycentrics);
  vec3 color = 0.5 * normal + 0.5;
  imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), vec4(color, 1.0));
}
