// expect: callable
#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 1) rayPayloadEXT vec3 light;
hitAttributeEXT RaypoolHit hit;

layout(location = 2) callableDataEXT vec3 answer;

void main() {
  executeCallableEXT(0, 2);  // here
}
