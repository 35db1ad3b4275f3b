// expect: sampler2DShadow
#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

layout(set = 1, binding = 0) uniform sampler2DShadow map;

void main() {
  light = vec3(textureLod(map, vec3(hit.barycentrics, 0.5), 0.0));  // here
}
