#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

struct Payload {
  float distance;
  uint kind;
  vec3 face;
  int skip;
};
layout(location = 0) rayPayloadInEXT Payload payload;

void main() { payload.distance = 1e30; }
