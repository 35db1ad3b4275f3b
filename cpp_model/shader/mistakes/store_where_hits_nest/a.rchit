// expect: a.rchit
// expect: imageStore
// expect: wait for each other
#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 mirrored;
hitAttributeEXT RaypoolHit hit;

void main() {
  const vec3 place = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT + 0.001 * hit.normal;
  mirrored = 0.5 * color;
  traceRayEXT(raypool_tree, gl_RayFlagsOpaqueEXT, 0xff, 0, 0, 0, place, 0.0, hit.normal, 1e30, 1);
  color += mirrored;
  imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), vec4(color, 1.0));
}
