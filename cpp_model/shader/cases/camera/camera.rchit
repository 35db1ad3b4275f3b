#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

struct Payload {
  uint seed;
};
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT RaypoolHit hit;

void main() {
  const vec3 shown = hit.normal * 0.5 + 0.5;
  const float noise = float(payload.seed * 2654435761u >> 8) / 16777216.0;
  imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), vec4(shown + noise / 256.0, 1.0));
}
