// expect: closest-hit
// expect: ray generation
#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

void main() {
  const vec3 place = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT + 0.001 * hit.normal;
  color *= 0.5;
  traceRayEXT(raypool_tree, gl_RayFlagsOpaqueEXT, 0xff, 0, 1, 0, place, 0.0, reflect(gl_WorldRayDirectionEXT, hit.normal), 1e30, 0);  // here
  traceRayEXT(raypool_tree, gl_RayFlagsOpaqueEXT, 0xff, 0, 1, 0, place, 0.0, gl_WorldRayDirectionEXT, 1e30, 0);
}
