#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 weight;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

layout(constant_id = 3) const float kReach = 2.0;
layout(constant_id = 4) const uint kStrata = 4;

vec2 hammersley(uint i, uint count) { return vec2(float(i) / float(count), float(bitfieldReverse(i)) * 2.3283064e-10); }

void main() {
  const uint number = (raypool_frame.sample_number + gl_LaunchIDEXT.x * 5u + gl_LaunchIDEXT.y * 3u) % (kStrata *
          kStrata);
  const vec2 u = hammersley(number, kStrata * kStrata);
  const float z = 1.0 - 2.0 * u.x, r = sqrt(max(0.0, 1.0 - z * z)), phi = 6.2831853 * u.y;
  const vec3 normal = faceforward(hit.normal, gl_WorldRayDirectionEXT, hit.normal);
  const vec3 direction = normal * 1.001 + vec3(r * cos(phi), r * sin(phi), z);
  const vec3 place = fma(vec3(gl_HitTEXT), gl_WorldRayDirectionEXT, gl_WorldRayOriginEXT);
  light = weight;
  traceRayEXT(raypool_tree, gl_RayFlagsTerminateOnFirstHitEXT |
          gl_RayFlagsSkipClosestHitShaderEXT, 0xff, 0, 0, 0, place,
              0.01, normalize(direction), kReach, 1);
}
