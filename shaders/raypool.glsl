// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What raypool gives every shader set: the frame, the scene, and functions that most shaders need. Include it after
// #version 460 and the #extension lines of your own. docs/use/scenes.md says which files have which of this data.
#ifndef RAYPOOL_GLSL
#define RAYPOOL_GLSL

#extension GL_EXT_ray_tracing : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_nonuniform_qualifier : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int16 : require

// What a closest-hit shader knows of its hit: hitAttributeEXT RaypoolHit hit;
struct RaypoolHit {
  vec2 barycentrics;  // of the second and third corner
  vec3 normal;        // of the triangle's plane, unit length, on the side from which the corners turn left
  uint material;      // byte address of the material record, for raypool_material() and raypool_record()
  uint depth;         // of the ray: 1 for an eye ray
};

// How RaypoolMaterial::alpha is meant.
const uint RAYPOOL_OPAQUE = 0u;   // not at all
const uint RAYPOOL_CUT_OUT = 1u;  // below alpha_cutoff there is no surface
const uint RAYPOOL_BLEND = 2u;    // the share of the light that the surface stops

// Metallic-roughness, as glTF defines it. Colours are linear. Texture 0 is one white texel, so a shader may sample it
// without a test, or leave it out.
struct RaypoolMaterial {
  vec3 base_color;                  // times texture, times vertex colour
  float alpha;                      // times those of texture and vertex colour
  vec3 emission;                    // radiance of both sides, times its texture
  float metallic;                   // 0 .. 1, times blue of its texture
  float roughness;                  // 0 .. 1, times green of its texture; its square is the width of highlights (alpha)
  float transmission;               // 0 .. 1: the share of the light beneath the surface that goes through
  float ior;                        // index of refraction, 1.5 where the file has none
  float alpha_cutoff;               // of RAYPOOL_CUT_OUT
  uint alpha_mode;                  // RAYPOOL_OPAQUE, ...
  uint base_color_texture;          // in raypool_textures; 0: none
  uint emission_texture;            // the same
  uint metallic_roughness_texture;  // the same
};

// What shines, for RaypoolLight::kind.
const uint RAYPOOL_POINT = 0u;        // color is radiant intensity: it falls with the square of the distance
const uint RAYPOOL_SPOT = 1u;         // the same, in a cone
const uint RAYPOOL_DIRECTIONAL = 2u;  // color is irradiance
const uint RAYPOOL_LAMP = 3u;         // raypool's own point light: color is irradiance at every distance
const uint RAYPOOL_TRIANGLE = 4u;     // of a material with emission and without a texture of it: color is its radiance

struct RaypoolLight {
  vec3 position;      // of a triangle its first corner
  uint kind;          // RAYPOOL_POINT, ...
  vec3 direction;     // in which it shines, unit length; of a triangle the edge to its second corner
  float spot_scale;   // cone: clamp(cosine spot_scale + spot_offset, 0, 1), squared
  vec3 edge;          // of a triangle the edge to its third corner
  float spot_offset;  // see spot_scale
  vec3 color;         // linear
  float probability;  // of raypool_choose_light() choosing it: its share of the light on what is seen, about
  float threshold;    // for raypool_choose_light()
  uint other;         // for raypool_choose_light()
  float range;        // beyond this distance it gives nothing; 0: there is no such
  uint triangle;      // its number, of a triangle
};

layout(set = 0, binding = 0) uniform accelerationStructureEXT raypool_tree;
// imageStore adds red, green and blue to the pixel.
layout(set = 0, binding = 1, rgba32f) uniform image2D raypool_picture;
// All of it but sample_number is known when the shaders are compiled.
layout(set = 0, binding = 2, scalar) uniform RaypoolFrame {
  vec3 eye;             // of the camera
  vec3 corner;          // direction through the centre of pixel (x, y): corner + x step_x + y step_y, from the top left
  vec3 step_x;
  vec3 step_y;
  vec3 light_position;  // of the one light of the built-in kernels (--light)
  vec3 light_color;
  vec3 background;      // what rays that meet nothing are to bring; of today's files always 0
  float offset;         // for raypool_offset_origin()
  uint width;           // of the picture, pixels
  uint height;
  uint sample_number;   // of this frame: 0 .. samples - 1
  uint samples;         // frames that are added up (--samples); weigh with 1 / samples
  uint depth;           // of the deepest rays (--depth)
  uint triangles;       // of the scene
  uint lights;          // elements of raypool_lights; at least 1
  float total_weight;   // a triangle light's probability is its area times raypool_luminance(color) / total_weight
  float far;            // longer than any distance within the scene
  vec3 alpha_center;    // of a sphere around all triangles that are not RAYPOOL_OPAQUE: light may pass through holes in
  float alpha_radius;   // them. 0: there are none
} raypool_frame;
// The vertices of each triangle, by gl_PrimitiveID.
layout(set = 0, binding = 3, scalar) readonly buffer RaypoolIndices { uvec3 raypool_indices[]; };
// [vertex] Vertices that differ in any of these are different ones.
layout(set = 0, binding = 4, scalar) readonly buffer RaypoolPositions { vec3 raypool_positions[]; };
layout(set = 0, binding = 5, scalar) readonly buffer RaypoolNormals { vec3 raypool_normals[]; };  // unit length
layout(set = 0, binding = 6, scalar) readonly buffer RaypoolTexcoords { vec2 raypool_texcoords[]; };  // v downwards
layout(set = 0, binding = 7, scalar) readonly buffer RaypoolColors { vec4 raypool_colors[]; };  // linear; 1 without
layout(set = 0, binding = 8, scalar) readonly buffer RaypoolMaterials { RaypoolMaterial raypool_materials[]; };
layout(set = 0, binding = 9, scalar) readonly buffer RaypoolLights { RaypoolLight raypool_lights[]; };
// Linear, also where the file has them in sRGB.
layout(set = 0, binding = 10) uniform sampler2D raypool_textures[];

// What RaypoolHit::material is the address of: the two colours that the built-in kernels use, and the way to the whole
// material.
struct RaypoolRecord {
  vec3 diffuse;      // the light that is scattered in all directions, for each colour its share: 0 .. 1
  uint material;     // byte address of the RaypoolMaterial
  vec3 reflectance;  // the light that is mirrored, the same; 0: the surface is no mirror
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer RaypoolRecordAt { RaypoolRecord record; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer RaypoolMaterialAt {
  RaypoolMaterial material;
};

RaypoolRecord raypool_record(uint address) { return RaypoolRecordAt(uvec2(address, 0u)).record; }

// Of RaypoolHit::material.
RaypoolMaterial raypool_material(uint address) {
  return RaypoolMaterialAt(uvec2(RaypoolRecordAt(uvec2(address, 0u)).record.material, 0u)).material;
}

// The direction, not normalised, of the eye ray through a point of a pixel: (0, 0) is its centre, -0.5 and 0.5 are its
// edges.
vec3 raypool_eye_direction(uvec2 pixel, vec2 within) {
  return (float(pixel.y) + within.y) * raypool_frame.step_y +
         ((float(pixel.x) + within.x) * raypool_frame.step_x + raypool_frame.corner);
}
vec3 raypool_eye_direction(uvec2 pixel) {
  return float(pixel.y) * raypool_frame.step_y + (float(pixel.x) * raypool_frame.step_x + raypool_frame.corner);
}

// Where rays that leave a hit begin: at the hit of a ray (origin, direction, t), moved off the surface to the side of
// `normal` by more than it can be off its plane. `normal` is RaypoolHit::normal, or its negative for the other side.
// The built-in kernels compute the same, in this order.
vec3 raypool_offset_origin(vec3 origin, vec3 direction, float t, vec3 normal) {
  vec3 hit = t * direction + origin;
  float largest = max(max(abs(hit.x), abs(hit.y)), abs(hit.z));
  float offset = (largest + t) * raypool_frame.offset;
  return offset * normal + hit;
}

// Between the three corners' values.
vec3 raypool_mix(vec2 barycentrics, vec3 a, vec3 b, vec3 c) {
  return barycentrics.y * (c - a) + (barycentrics.x * (b - a) + a);
}
vec2 raypool_mix(vec2 barycentrics, vec2 a, vec2 b, vec2 c) {
  return barycentrics.y * (c - a) + (barycentrics.x * (b - a) + a);
}
vec4 raypool_mix(vec2 barycentrics, vec4 a, vec4 b, vec4 c) {
  return barycentrics.y * (c - a) + (barycentrics.x * (b - a) + a);
}

// Of a hit: `triangle` is gl_PrimitiveID.
vec3 raypool_position(uint triangle, vec2 barycentrics) {
  uvec3 corners = raypool_indices[triangle];
  return raypool_mix(barycentrics, raypool_positions[corners.x], raypool_positions[corners.y],
                     raypool_positions[corners.z]);
}
// Unit length: the smooth normal, or the triangle's own where the file has none.
vec3 raypool_normal(uint triangle, vec2 barycentrics) {
  uvec3 corners = raypool_indices[triangle];
  vec3 normal = raypool_mix(barycentrics, raypool_normals[corners.x], raypool_normals[corners.y],
                            raypool_normals[corners.z]);
  return normal * inversesqrt(max(dot(normal, normal), 1e-30));
}
vec2 raypool_texcoord(uint triangle, vec2 barycentrics) {
  uvec3 corners = raypool_indices[triangle];
  return raypool_mix(barycentrics, raypool_texcoords[corners.x], raypool_texcoords[corners.y],
                     raypool_texcoords[corners.z]);
}
vec4 raypool_color(uint triangle, vec2 barycentrics) {
  uvec3 corners = raypool_indices[triangle];
  return raypool_mix(barycentrics, raypool_colors[corners.x], raypool_colors[corners.y], raypool_colors[corners.z]);
}
// Of raypool_textures; 0 is white.
vec4 raypool_texture(uint number, vec2 texcoord) {
  return textureLod(raypool_textures[nonuniformEXT(number)], texcoord, 0.0);
}

// Whether there may be holes, or anything else that lets light pass, between `origin` and `origin + direction`.
bool raypool_near_alpha(vec3 origin, vec3 direction) {
  vec3 to_center = raypool_frame.alpha_center - origin;
  float nearest = clamp(dot(to_center, direction) / max(dot(direction, direction), 1e-30), 0.0, 1.0);
  vec3 apart = to_center - nearest * direction;
  return dot(apart, apart) < raypool_frame.alpha_radius * raypool_frame.alpha_radius;
}

float raypool_luminance(vec3 color) { return dot(color, vec3(0.2126, 0.7152, 0.0722)); }

// Random numbers without a state: a number each for pixel, depth of the ray, sample, and `which` of several.
uint raypool_hash(uint x) {
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  return x ^ (x >> 16);
}
uint raypool_seed(uvec2 pixel, uint depth) {
  return raypool_hash((pixel.x | pixel.y << 16) ^ raypool_hash(raypool_frame.sample_number << 8 | depth));
}
// In 0 .. 1, without 1.
float raypool_random(uint seed, uint which) {
  return uintBitsToFloat(0x3f800000u | raypool_hash(seed + which * 0x9e3779b9u) >> 9) - 1.0;
}

// A light of raypool_lights, chosen with its probability; `random` in 0 .. 1.
uint raypool_choose_light(float random) {
  float place = random * float(raypool_frame.lights);
  uint number = min(uint(place), raypool_frame.lights - 1u);
  return place - float(number) < raypool_lights[number].threshold ? number : raypool_lights[number].other;
}

// What a light gives a point.
struct RaypoolLit {
  vec3 direction;    // to the light, not normalised: a shadow ray from the point goes to t = 1
  vec3 irradiance;   // of a surface that faces it, divided by its probability
  float likelihood;  // of this direction, per solid angle; 0: no ray finds the light by chance
};
// `random` chooses the point of a triangle; both in 0 .. 1.
RaypoolLit raypool_light(uint number, vec3 point, vec2 random) {
  uint kind = raypool_lights[number].kind;
  vec3 place = raypool_lights[number].position;
  vec3 along = raypool_lights[number].direction;
  float strength = 1.0 / raypool_lights[number].probability;
  RaypoolLit lit;
  lit.likelihood = 0.0;
  if (kind == RAYPOOL_DIRECTIONAL) {
    lit.direction = along * -raypool_frame.far;
  } else if (kind == RAYPOOL_TRIANGLE) {
    vec3 edge = raypool_lights[number].edge;
    float root = sqrt(random.x);
    lit.direction = place + (root * (1.0 - random.y)) * along + (root * random.y) * edge - point;
    float square = dot(lit.direction, lit.direction);
    vec3 twice = cross(along, edge);  // twice the area
    // area cosine / distance^2
    float solid = 0.5 * abs(dot(twice, lit.direction)) / max(square * sqrt(square), 1e-30);
    lit.likelihood = raypool_lights[number].probability / max(solid, 1e-30);
    strength *= solid;
  } else {
    lit.direction = place - point;
    float square = dot(lit.direction, lit.direction);
    if (kind != RAYPOOL_LAMP) {
      float range = raypool_lights[number].range;
      strength = range > 0.0 && square > range * range ? 0.0 : strength / max(square, 1e-30);
    }
    if (kind == RAYPOOL_SPOT) {
      float cosine = -dot(lit.direction, along) * inversesqrt(max(square, 1e-30));
      float cone = clamp(cosine * raypool_lights[number].spot_scale + raypool_lights[number].spot_offset, 0.0, 1.0);
      strength *= cone * cone;
    }
  }
  lit.irradiance = raypool_lights[number].color * strength;
  return lit;
}
// RaypoolLit::likelihood of a direction by which a ray has found a triangle with emission: the ray's direction and t,
// the triangle's normal, and emission and emission_texture of its material. 0: it is not one of the lights.
float raypool_light_likelihood(vec3 direction, float t, vec3 normal, vec3 emission, uint emission_texture) {
  if (emission_texture != 0u) return 0.0;
  float square = dot(direction, direction);
  float cosine = abs(dot(normal, direction)) * inversesqrt(square);
  return raypool_luminance(emission) * t * t * square / max(raypool_frame.total_weight * cosine, 1e-30);
}

#endif
