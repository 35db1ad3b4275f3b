#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 weight;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

void main() {
  const vec3 normal = faceforward(hit.normal, gl_WorldRayDirectionEXT, hit.normal);
  vec3 place = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  place += normal * (raypool_frame.offset * (gl_HitTEXT + max(abs(place.x), max(abs(place.y), abs(place.z)))));
  const vec3 to_light = raypool_frame.light_position - place;
  const float cosine = dot(normal, normalize(to_light));
  if (cosine <= 0.0) return;
  light = weight * raypool_frame.light_color * cosine;
  const uint flags = gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsOpaqueEXT | gl_RayFlagsSkipClosestHitShaderEXT;
  traceRayEXT(raypool_tree, flags, 0xff, 0, 0, 0, place, 0.0, to_light, 1.0, 1);
}
