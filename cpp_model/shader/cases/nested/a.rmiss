#version 460
#extension GL_EXT_ray_tracing : require

struct Payload {
  vec3 color;
  int depth;
};
layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  const float t = 0.5 * (normalize(gl_WorldRayDirectionEXT).y + 1.0);
  payload.color = mix(vec3(1.0), vec3(0.5, 0.7, 1.0), t);
}
