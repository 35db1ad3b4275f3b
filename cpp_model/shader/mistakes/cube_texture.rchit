// expect: ube
#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

layout(set = 1, binding = 0) uniform samplerCube sky;

void main() {
  light = textureLod(sky, hit.normal, 0.0).rgb;  // here
}
