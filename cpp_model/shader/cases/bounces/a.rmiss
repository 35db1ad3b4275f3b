#version 460
#extension GL_EXT_ray_tracing : require

struct Payload {
  vec3 radiance, weight, origin, direction;
  uint seed;
  int done;
};
layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  payload.radiance = payload.weight * vec3(0.1, 0.2, 0.4);
  payload.done = 1;
}
