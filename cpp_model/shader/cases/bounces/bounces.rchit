#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

struct Payload {
  vec3 radiance, weight, origin, direction;
  uint seed;
  int done;
};
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) rayPayloadEXT uint blocked;
hitAttributeEXT RaypoolHit hit;

float random(inout uint seed) {
  seed = seed * 1664525u + 1013904223u;
  return float(seed >> 8) / 16777216.0;
}

void main() {
  const vec3 direction = gl_WorldRayDirectionEXT;
  const vec3 normal = dot(hit.normal, direction) > 0.0 ? -hit.normal : hit.normal;
  const vec3 position = gl_WorldRayOriginEXT + direction * gl_HitTEXT + normal * 0.002;
  const vec3 color = hit.normal * 0.3 + 0.5;
  const vec3 to_light = vec3(0.2, 0.7, 0.3) - position;
  blocked = 1u;
  const float cosine = dot(normal, normalize(to_light));
  if (cosine > 0.0) {
    traceRayEXT(raypool_tree, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xff, 0, 0, 1,
                position, 0.0, to_light, 1.0, 1);
  }
  payload.radiance = blocked == 0u ? payload.weight * color * cosine : vec3(0.0);
  payload.weight *= color;
  const float phi = 6.2831853 * random(payload.seed), z = random(payload.seed), r = sqrt(max(0.0, 1.0 - z * z));
  const vec3 side = normalize(abs(normal.x) > 0.5 ? vec3(normal.y, -normal.x, 0.0) : vec3(0.0, normal.z, -normal.y));
  payload.direction = normalize(r * cos(phi) * side + r * sin(phi) * cross(normal, side) + z * normal);
  payload.origin = position;
  payload.done = 0;
}
