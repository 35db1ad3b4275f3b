// expect: rayQueryEXT
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_query : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

void main() {
  rayQueryEXT query;  // here
  rayQueryInitializeEXT(query, raypool_tree, 0, 0xff, gl_WorldRayOriginEXT, 0.0, hit.normal, 1.0);
  light = vec3(rayQueryProceedEXT(query) ? 0.0 : 1.0);
}
