#version 460
// The constant `show` chooses what is seen. It is known when the kernels are compiled, so only its branch is left.
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"

// 0: smooth normals, 1: the triangles' normals, 2: barycentrics, 3: nearness, 4: materials, 5: triangles, 6: texture
// coordinates, 7: sides (green is the front)
layout(constant_id = 0) const uint show = 0u;

layout(location = 0) rayPayloadInEXT float weight;
hitAttributeEXT RaypoolHit hit;

vec3 color_of(uint number) {
  const uint bits = raypool_hash(number);
  return vec3(ivec3(bits & 0xffu, bits >> 8 & 0xffu, bits >> 16 & 0xffu)) * (1.0 / 255.0);
}

void main() {
  const uint triangle = uint(gl_PrimitiveID);
  vec3 color;
  switch (show) {
    case 0u:
      color = 0.5 * raypool_normal(triangle, hit.barycentrics) + 0.5;
      break;
    case 1u:
      color = 0.5 * hit.normal + 0.5;
      break;
    case 2u:
      color = vec3(1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics);
      break;
    case 3u: {
      // A tenth of the scene away is half as bright.
      const float distance = gl_HitTEXT * length(gl_WorldRayDirectionEXT);
      color = vec3(1.0 / (1.0 + 10.0 * distance / raypool_frame.far));
      break;
    }
    case 4u:
      color = color_of(hit.material);
      break;
    case 5u:
      color = color_of(triangle);
      break;
    case 6u:
      color = vec3(fract(raypool_texcoord(triangle, hit.barycentrics)), 0.0);
      break;
    default:
      color = dot(gl_WorldRayDirectionEXT, hit.normal) > 0.0 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
      break;
  }
  imageStore(raypool_picture, ivec2(gl_LaunchIDEXT.xy), vec4(weight * color, 1.0));
}
