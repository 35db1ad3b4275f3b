#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 weight;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

const uint kShadow = gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT;

float schlick(float cosine, float straight) { return straight + (1.0 - straight) * pow(1.0 - cosine, 5.0); }

void main() {
  const vec3 incoming = normalize(gl_WorldRayDirectionEXT);
  const bool inside = dot(incoming, hit.normal) > 0.0;
  const vec3 normal = inside ? -hit.normal : hit.normal;
  const vec3 place = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT + 1e-3 * normal;
  const float mirrored = schlick(-dot(incoming, normal), 0.25) / float(hit.depth);
  const vec3 to_light = raypool_frame.light_position - place;
  light = weight * (1.0 - mirrored) * max(dot(normal, normalize(to_light)), 0.0);
  traceRayEXT(raypool_tree, kShadow, 0xff, 0, 0, 0, place, 0.0, to_light, 1.0, 1);
  weight *= mirrored;
  traceRayEXT(raypool_tree, gl_RayFlagsOpaqueEXT, 0xff, 0, 0, 0, place, 0.001, reflect(incoming, normal), 1e4, 0);
}
