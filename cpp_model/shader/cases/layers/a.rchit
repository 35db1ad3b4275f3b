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
hitAttributeEXT RaypoolHit hit;

void main() {
  payload.distance = gl_HitTEXT;
  payload.kind = gl_HitKindEXT;
  payload.face = dot(hit.normal, gl_WorldRayDirectionEXT) > 0.0 ? -hit.normal : hit.normal;
}
