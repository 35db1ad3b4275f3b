#version 460
#extension GL_EXT_ray_tracing : require

struct Payload {
  vec3 color;
  float distance;
  uint passed;
};
layout(location = 1) rayPayloadInEXT Payload shadow;

void main() { shadow.distance = 1.0; }
