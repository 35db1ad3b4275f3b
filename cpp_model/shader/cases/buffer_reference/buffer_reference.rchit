#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

hitAttributeEXT RaypoolHit hit;

layout(buffer_reference, scalar) readonly buffer Record {
  vec3 diffuse;
  uint material;
  vec3 reflectance;
};
layout(buffer_reference, scalar) readonly buffer Material { vec4 base_color; };

void main() {
  Record record = Record(uvec2(hit.material, 0u));
  vec3 color = record.diffuse + record.reflectance;
  if (record.material != 0u) color = Material(uvec2(record.material, 0u)).base_color.rgb;
  imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), vec4(color, 1.0));
}
