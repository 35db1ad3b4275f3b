// expect: 64-bit
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

void main() {
  const uint64_t product = uint64_t(hit.material) * 3ul; 
  light = vec3(float(product));  // here
}
