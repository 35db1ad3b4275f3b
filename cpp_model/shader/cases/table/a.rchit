#version 460
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"
#include "common.glsl"

layout(buffer_reference, scalar) readonly buffer Vertices { Vertex of[]; };
layout(buffer_reference, scalar) readonly buffer Indices { ivec3 of[]; };
layout(buffer_reference, scalar) readonly buffer Materials { Material of[]; };
layout(buffer_reference, scalar) readonly buffer Numbers { int of[]; };
layout(set = 1, binding = 0, scalar) readonly buffer Objects { Object objects[]; };
layout(push_constant, std430) uniform Constants {
  int frame;
  Numbers numbers[2];
  uvec2 indices;
} constants;
layout(shaderRecordEXT, std430) buffer Record {
  float weights[2];
  uint number;
} record;
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) rayPayloadEXT uint blocked;
hitAttributeEXT RaypoolHit hit;

void put(uint bit, bool right) { payload.right |= right ? 1u << bit : 0u; }

void main() {
  const Object object = objects[gl_InstanceCustomIndexEXT];
  const ivec3 corners = Indices(object.indices).of[gl_PrimitiveID];
  Vertices vertices = Vertices(object.vertices);
  const Vertex a = vertices.of[corners.x], b = vertices.of[corners.y], c = vertices.of[corners.z];
  const vec3 shares = vec3(1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics);
  const vec3 place = a.position * shares.x + b.position * shares.y + c.position * shares.z;
  put(0u, distance(place, raypool_position(gl_PrimitiveID, hit.barycentrics)) < 1e-5);
  put(1u, a.normal == raypool_normals[corners.x] && object.first_texture == 7);

  const int number = Numbers(object.material_numbers).of[gl_PrimitiveID];
  const RaypoolMaterial material = raypool_materials[number];
  put(2u, number == gl_GeometryIndexEXT && raypool_material(hit.material) == material);
  const Material its = Materials(object.materials + 32ul * uint64_t(number)).of[0];
  put(3u, its.ambient == vec3(0.25) && distance(its.diffuse, material.base_color * (1.0 - material.metallic)) < 1e-6);
  put(4u, its.roughness == material.roughness && its.texture_number == int(material.base_color_texture));
  put(5u, record.number == 5u && record.weights[gl_PrimitiveID & 1] == 0.5 + float(gl_PrimitiveID & 1));

  // Its group has an any-hit shader alone, which says that it was asked.
  blocked = 0u;
  const vec3 origin =
      raypool_offset_origin(gl_WorldRayOriginEXT, gl_WorldRayDirectionEXT, gl_HitTEXT,
                            dot(hit.normal, gl_WorldRayDirectionEXT) > 0.0 ? -hit.normal : hit.normal);
  traceRayEXT(raypool_tree, gl_RayFlagsNoneEXT, 0xff, 1, 0, 1, origin, 0.0, gl_WorldRayDirectionEXT * -1.0, 1e30, 1);
  put(6u, blocked == 3u || blocked == 4u);
  const bool is_first = constants.numbers[0].of[gl_PrimitiveID] == number;
  put(7u, is_first && constants.numbers[1].of[2] == 9 && Indices(constants.indices).of[gl_PrimitiveID] == corners);
  ++payload.count;
}
