#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_int16 : require
#include "raypool.glsl"

struct Path {
  uint seed;
  vec2 weight;
  uint16_t bounces;
};
layout(location = 0) rayPayloadInEXT Path path;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

const float kPi = 3.14159265;

float next(inout uint state) {
  state = state * 747796405u + 2891336453u;
  const uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return float(((word >> 22u) ^ word) >> 8) * (1.0 / 16777216.0);
}

void tangents(vec3 n, out vec3 s, out vec3 t) {
  s = normalize(abs(n.x) > 0.5 ? vec3(-n.y, n.x, 0.0) : vec3(0.0, -n.z, n.y));
  t = cross(n, s);
}

void main() {
  const vec3 normal = dot(gl_WorldRayDirectionEXT, hit.normal) < 0.0 ? hit.normal : -hit.normal;
  const vec3 place = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT + 1e-3 * normal;
  uint seed = path.seed;
  vec2 weight = path.weight * 0.75;

  const vec3 to_light = raypool_frame.light_position - place;
  const float cosine = dot(normal, normalize(to_light));
  if (cosine > 0.0) {
    light = vec3(weight, 0.5 * (weight.x + weight.y)) * raypool_frame.light_color * cosine / kPi;
    traceRayEXT(raypool_tree, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xff, 0, 0, 0,
                place, 0.0, to_light, 1.0, 1);
  }

  const float survival = clamp(max(weight.x, weight.y), 0.05, 0.95);
  if (next(seed) > survival || path.bounces >= uint16_t(8)) return;
  const float angle = 2.0 * kPi * next(seed), height = next(seed);
  vec3 s, t;
  tangents(normal, s, t);
  path.seed = seed;
  path.weight = weight / survival;
  path.bounces += uint16_t(1);
  const vec3 direction = sqrt(height) * (cos(angle) * s + sin(angle) * t) + sqrt(1.0 - height) * normal;
  traceRayEXT(raypool_tree, gl_RayFlagsOpaqueEXT, 0xff, 0, 0, 0, place, 0.0, direction, 1e30, 0);
}
