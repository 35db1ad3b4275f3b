#version 460
// One shadow ray a hit and sample. Directions near the normal are likelier, by the cosine with which they would light
// the surface, so that each has the same weight.
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"
#include "sampling.glsl"

// How near is near, as a share of twice the scene's diagonal.
layout(constant_id = 0) const float reach = 0.05;

layout(location = 0) rayPayloadInEXT float weight;
layout(location = 1) rayPayloadEXT vec3 contribution;
hitAttributeEXT RaypoolHit hit;

void main() {
  const vec3 face = dot(gl_WorldRayDirectionEXT, hit.normal) > 0.0 ? -hit.normal : hit.normal;
  vec3 normal = raypool_normal(uint(gl_PrimitiveID), hit.barycentrics);
  if (dot(normal, face) < 0.0) normal = -normal;

  const uint seed = raypool_seed(gl_LaunchIDEXT.xy, hit.depth);
  const vec3 direction =
      cosine_direction(normal, random_direction(raypool_random(seed, 0u), raypool_random(seed, 1u)));
  // A smooth normal may lean so far that a direction lies behind the triangle.
  if (dot(direction, face) > 0.0) {
    contribution = vec3(weight);
    traceRayEXT(raypool_tree, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xffu, 0u, 0u, 0u,
                raypool_offset_origin(gl_WorldRayOriginEXT, gl_WorldRayDirectionEXT, gl_HitTEXT, face), 0.0, direction,
                reach * raypool_frame.far, 1);
  }
}
