// expect: gl_RayFlagsCullOpaqueEXT
#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

const uint kShadow = gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT;

void main() {
  const vec3 place = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT + 0.001 * hit.normal;
  light = color;
  traceRayEXT(raypool_tree, kShadow | gl_RayFlagsCullOpaqueEXT, 0xff, 0, 1, 0, place, 0.0, hit.normal, 1.0, 1);  // here
}
