#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT float weight;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

void main() {
  vec3 normal = raypool_normal(gl_PrimitiveID, hit.barycentrics);
  vec3 face = dot(gl_WorldRayDirectionEXT, hit.normal) > 0.0 ? -hit.normal : hit.normal;
  vec3 origin = raypool_offset_origin(gl_WorldRayOriginEXT, gl_WorldRayDirectionEXT, gl_HitTEXT, face);
  vec3 to_light = raypool_frame.light_position - origin;
  vec3 color = raypool_record(hit.material).diffuse;
  light = color * raypool_frame.light_color * abs(dot(normal, normalize(to_light)));
  traceRayEXT(raypool_tree, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xffu, 0u, 0u, 0u,
              origin, 0.0, to_light, 1.0, 1);
}
