#version 460
#extension GL_EXT_ray_tracing : require

layout(location = 0) rayPayloadInEXT vec3 found;
layout(location = 2) rayPayloadEXT bool shadowed;
hitAttributeEXT vec2 attributes;

layout(binding = 0, set = 0) uniform accelerationStructureEXT scene;
layout(binding = 2, set = 0) uniform Camera {
  mat4 viewInverse;
  mat4 projInverse;
  vec4 light_position;
} camera;
layout(binding = 3, set = 0, std430) readonly buffer Vertices { vec4 v[]; } vertices;
layout(binding = 4, set = 0) readonly buffer Indices { uint i[]; } indices;

struct Vertex {
  vec3 position;
  vec3 normal;
  vec4 color;
};

Vertex fetch(uint index) {
  const vec4 d0 = vertices.v[3 * index], d1 = vertices.v[3 * index + 1], d2 = vertices.v[3 * index + 2];
  Vertex v;
  v.position = d0.xyz;
  v.normal = vec3(d0.w, d1.xy);
  v.color = vec4(d2.xyz, 1.0);
  return v;
}

void main() {
  const ivec3 index = ivec3(indices.i[3 * gl_PrimitiveID], indices.i[3 * gl_PrimitiveID + 1],
                            indices.i[3 * gl_PrimitiveID + 2]);
  const Vertex v0 = fetch(index.x), v1 = fetch(index.y), v2 = fetch(index.z);
  const vec3 share = vec3(1.0 - attributes.x - attributes.y, attributes.x, attributes.y);
  const vec3 normal = normalize(v0.normal * share.x + v1.normal * share.y + v2.normal * share.z);
  const vec3 to_light = normalize(camera.light_position.xyz);
  const float facing = max(dot(to_light, normal), 0.2);
  found = v0.color.rgb * facing;

  shadowed = true;
  const vec3 origin = gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT * gl_HitTEXT;
  traceRayEXT(scene,
              gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsOpaqueEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xff, 0,
              0, 1, origin + normal * 0.01, 0.001, to_light, 10000.0, 2);
  if (shadowed) found *= 0.3;
}
