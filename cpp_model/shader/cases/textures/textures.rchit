#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

hitAttributeEXT RaypoolHit hit;

layout(set = 1, binding = 0) uniform sampler2D wood;
layout(set = 1, binding = 1) uniform sampler2D tiles[3];

void main() {
  const uvec3 corners = raypool_indices[gl_PrimitiveID];
  const vec2 uv = mix(mix(raypool_texcoords[corners.x], raypool_texcoords[corners.y], hit.barycentrics.x),
                      raypool_texcoords[corners.z], hit.barycentrics.y);
  vec4 color = texture(wood, uv);
  color.rgb *= textureLod(tiles[nonuniformEXT(gl_PrimitiveID % 3)], uv.yx * 2.0, 0.0).rgb;
  if (color.a < 0.5) color = vec4(0.0);
  imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), color);
}
