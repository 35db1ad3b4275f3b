#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

struct Payload {
  vec3 color;
  int depth;
};
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) rayPayloadEXT Payload mirrored;
hitAttributeEXT vec2 attributes;
layout(constant_id = 0) const int BOUNCES = 5;

void main() {
  const uvec3 corners = raypool_indices[gl_PrimitiveID];
  const vec3 a = raypool_positions[corners.x], b = raypool_positions[corners.y], c = raypool_positions[corners.z];
  const vec3 plain = normalize(cross(b - a, c - a));
  const vec3 normal = dot(plain, gl_WorldRayDirectionEXT) > 0.0 ? -plain : plain;
  const float facing = max(dot(-gl_WorldRayDirectionEXT, normal), 0.2);
  payload.color = (normal * 0.5 + 0.5) * facing;
  if ((gl_PrimitiveID & 1) != 0) return;
  payload.color *= 0.25;
  if (payload.depth + 1 >= BOUNCES) return;
  // The shader waits for itself.
  const vec3 hit = gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT * gl_RayTmaxEXT;
  mirrored = Payload(vec3(0.0), payload.depth + 1);  // which is what it stays where --depth traces no ray
  traceRayEXT(raypool_tree, gl_RayFlagsOpaqueEXT, 0xff, 0, 0, 0, hit + normal * 0.001, 0.001,
              reflect(gl_WorldRayDirectionEXT, normal), 10000.0, 1);
  payload.color += mirrored.color;
}
