#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

struct Payload {
  vec3 color;
  float distance;
  uint passed;
};
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) rayPayloadEXT Payload shadow;
hitAttributeEXT RaypoolHit hit;

void main() {
  const vec3 face = dot(hit.normal, gl_WorldRayDirectionEXT) > 0.0 ? -hit.normal : hit.normal;
  const vec3 point = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT + 0.002 * face;
  const vec3 to_light = raypool_frame.light_position - point;
  shadow.distance = 0.0;
  shadow.passed = 0u;
  traceRayEXT(raypool_tree, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xff, 0, 0, 1,
              point, 0.0, to_light, 1.0, 1);
  const float cosine = max(dot(face, normalize(to_light)), 0.0);
  payload.color = vec3(0.2) + (hit.normal * 0.3 + 0.5) * cosine * shadow.distance;
  payload.passed += shadow.passed;
  payload.distance = gl_HitTEXT;
}
