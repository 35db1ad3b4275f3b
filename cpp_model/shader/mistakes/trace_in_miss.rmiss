// expect: a miss shader traces a ray
#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 1) rayPayloadInEXT vec3 light;

void main() {
  traceRayEXT(raypool_tree, gl_RayFlagsOpaqueEXT, 0xff, 0, 1, 0, gl_WorldRayOriginEXT, 0.0, -gl_WorldRayDirectionEXT, 1e30, 1);  // here
}
