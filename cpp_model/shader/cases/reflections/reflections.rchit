#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

struct Payload {
  vec3 color;
  float distance;
  vec3 normal;
  float mirror;
};
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 attributes;

void main() {
  const uvec3 corners = raypool_indices[gl_PrimitiveID];
  const vec3 a = raypool_positions[corners.x], b = raypool_positions[corners.y], c = raypool_positions[corners.z];
  const vec3 plain = normalize(cross(b - a, c - a));
  const vec3 normal = dot(plain, gl_WorldRayDirectionEXT) > 0.0 ? -plain : plain;
  const float facing = max(dot(-gl_WorldRayDirectionEXT, normal), 0.2);
  payload.color = (normal * 0.5 + 0.5) * facing;
  payload.distance = gl_RayTmaxEXT;
  payload.normal = normal;
  payload.mirror = (gl_PrimitiveID & 1) == 0 ? 1.0 : 0.0;
}
