#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

struct Payload {
  uint number;
  vec4 values;
  vec2 pair;
};
layout(shaderRecordEXT, std430) buffer Record { uint material; } record;
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT RaypoolHit hit;

void main() {
  payload.number = record.material + 1u;
  payload.values = vec4(float(gl_GeometryIndexEXT));
  const bool same = raypool_material(hit.material) == raypool_materials[record.material];
  payload.pair = same ? vec2(float(record.material)) : vec2(-1.0);
}
