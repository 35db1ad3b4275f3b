#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

hitAttributeEXT RaypoolHit hit;

struct Vertex {
  vec3 position, normal;
  vec2 texcoord;
  vec4 color;
};

Vertex vertex_of(uint index) {
  Vertex v;
  v.position = raypool_positions[index];
  v.normal = raypool_normals[index];
  v.texcoord = raypool_texcoords[index];
  v.color = raypool_colors[index];
  return v;
}

void main() {
  const uvec3 corners = raypool_indices[gl_PrimitiveID];
  const Vertex a = vertex_of(corners.x), b = vertex_of(corners.y), c = vertex_of(corners.z);
  const vec3 share = vec3(1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics.xy);
  const vec3 normal = normalize(a.normal * share.x + b.normal * share.y + c.normal * share.z);
  const vec2 texcoord = mat3x2(a.texcoord, b.texcoord, c.texcoord) * share;
  const ivec2 cell = ivec2(floor(texcoord * 8.0));
  const float checker = ((cell.x ^ cell.y) & 1) == 0 ? 1.0 : 0.25;
  const vec4 color = a.color * share.x + b.color * share.y + c.color * share.z;
  const float facing = abs(dot(normal, normalize(gl_WorldRayDirectionEXT)));
  imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), vec4(color.rgb * checker * facing, color.a));
}
