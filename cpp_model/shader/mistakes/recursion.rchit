// expect: ecursi
#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

float fold(int n) { return n == 0 ? hit.barycentrics.x : sqrt(fold(n - 1)); }  // here

void main() {
  light = vec3(fold(3));
}
