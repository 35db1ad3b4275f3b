#version 460
// What is seen is matt and lit by one point light; a shadow ray carries its light, and comes back only if it meets
// nothing. A mirror's ray goes on with the weight that is left. The order of operations decides the last bits: it is
// that of cast_secondary in cpp_model/kernel/ray_kernels.hpp.
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 weight;
layout(location = 1) rayPayloadEXT vec3 contribution;
hitAttributeEXT RaypoolHit hit;

void main() {
  const float infinity = uintBitsToFloat(0x7f800000u);
  const float projection = dot(gl_WorldRayDirectionEXT, hit.normal);
  const vec3 normal = projection > 0.0 ? -hit.normal : hit.normal;  // on the ray's side
  const vec3 origin = raypool_offset_origin(gl_WorldRayOriginEXT, gl_WorldRayDirectionEXT, gl_HitTEXT, normal);
  const vec3 reflected = (projection * -2.0) * hit.normal + gl_WorldRayDirectionEXT;

  const vec3 to_light = raypool_frame.light_position - origin;
  const float cosine = dot(normal, to_light) * inversesqrt(dot(to_light, to_light));
  const float lit = min(max(cosine, 0.0), 1.0);

  const RaypoolRecord material = raypool_record(hit.material);
  contribution = weight * material.diffuse * (lit * raypool_frame.light_color);
  weight *= material.reflectance;
  traceRayEXT(raypool_tree, gl_RayFlagsNoneEXT, 0xffu, 0u, 0u, 0u, origin, 0.0, reflected, infinity, 0);
  traceRayEXT(raypool_tree, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xffu, 0u, 0u, 0u,
              origin, 0.0, to_light, 1.0, 1);
}
