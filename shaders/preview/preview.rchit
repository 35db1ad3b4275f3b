#version 460
// Light from the viewer's side, which needs no ray, shows every surface; a shadow ray to a lamp above the viewer's left
// shoulder shows where surfaces touch. What is cut out, and the share that a transparent surface lets through, the ray
// sees from there on.
//
// A shadow ray ends at the first triangle, even where that has a hole. So from a surface that ends the eye ray another
// one like it goes to the lamp, where a scene has holes. At each hole it sends a shadow ray that looks whether the rest
// of the way is free, and goes on behind it.
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"
#include "sampling.glsl"
#include "background.glsl"
#include "payload.glsl"

// How far shadows reach, as a share of twice the scene's diagonal: a ceiling far above leaves the floor lit.
layout(constant_id = 0) const float reach = 0.05;

layout(location = 0) rayPayloadInEXT Sight sight;
layout(location = 1) rayPayloadEXT vec3 contribution;
hitAttributeEXT RaypoolHit hit;

// The share of light that the surface stops.
float coverage(RaypoolMaterialAt at, float alpha) {
  if (at.material.alpha_mode == RAYPOOL_CUT_OUT) return alpha < at.material.alpha_cutoff ? 0.0 : 1.0;
  return (at.material.alpha_mode == RAYPOOL_BLEND ? alpha : 1.0) * (1.0 - 0.75 * at.material.transmission);
}

// The same on the way to the lamp, which glass hides.
float shadow_coverage(RaypoolMaterialAt at, float alpha) {
  if (at.material.alpha_mode == RAYPOOL_CUT_OUT) return alpha < at.material.alpha_cutoff ? 0.0 : 1.0;
  return at.material.alpha_mode == RAYPOOL_BLEND ? alpha : 1.0;
}

vec3 to_lamp() {
  const vec2 half_size = vec2(raypool_frame.width, raypool_frame.height) * 0.5 - 0.5;
  const vec3 forward = half_size.y * raypool_frame.step_y + (half_size.x * raypool_frame.step_x + raypool_frame.corner);
  const vec3 up_left = -0.5 * normalize(raypool_frame.step_x) - 0.9 * normalize(raypool_frame.step_y);
  return normalize(up_left - 0.7 * normalize(forward));
}

void main() {
  const uvec2 pixel = gl_LaunchIDEXT.xy;
  const uint triangle = uint(gl_PrimitiveID);
  // Read where it is needed, so that registers need not hold it.
  RaypoolMaterialAt at = RaypoolMaterialAt(uvec2(raypool_record(hit.material).material, 0u));
  const vec2 texcoord = raypool_texcoord(triangle, hit.barycentrics);
  vec4 color = raypool_color(triangle, hit.barycentrics) * vec4(at.material.base_color, at.material.alpha);
  if (at.material.base_color_texture != 0u) color *= raypool_texture(at.material.base_color_texture, texcoord);
  vec3 emission = at.material.emission;
  if (emission != vec3(0.0)) emission *= raypool_texture(at.material.emission_texture, texcoord).rgb;
  const bool holes = raypool_frame.alpha_radius > 0.0;
  const bool seeks_lamp = holes && is_to_lamp(sight);
  const vec3 brought = light_of(sight);
  const float stopped = sight.weight * coverage(at, color.a);

  const vec3 ray = gl_WorldRayDirectionEXT;
  const vec3 face = dot(ray, hit.normal) > 0.0 ? -hit.normal : hit.normal;
  vec3 normal = raypool_normal(triangle, hit.barycentrics);
  if (dot(normal, face) < 0.0) normal = -normal;

  vec3 direction = to_lamp();
  float limit = reach * raypool_frame.far;
  if (raypool_frame.samples > 1u) {
    // A lamp of some size, for soft shadows, which fade out where they end.
    const uint seed = raypool_seed(pixel, hit.depth);
    direction = normalize(0.3 * random_direction(raypool_random(seed, 0u), raypool_random(seed, 1u)) + direction);
    limit *= 2.0 * raypool_random(seed, 2u);
  }
  const float lamp = dot(direction, face) > 0.0 ? max(dot(direction, normal), 0.0) : 0.0;
  const float facing = clamp(-dot(ray, normal) * inversesqrt(dot(ray, ray)), 0.0, 1.0);
  contribution = (0.6 * stopped * lamp) * color.rgb;
  const vec3 seen = stopped * max((0.35 * facing + 0.12) * color.rgb + emission - background(pixel), vec3(0.0));
  sight.weight -= stopped;

  // Nothing of the hit is needed after the first ray has left, so nothing of it has to be kept.
  const vec3 before = raypool_offset_origin(gl_WorldRayOriginEXT, ray, gl_HitTEXT, face);
  const vec3 behind = raypool_offset_origin(gl_WorldRayOriginEXT, ray, gl_HitTEXT, -face);
  vec3 start = behind, onwards = ray, shadow_start = before;
  bool goes_on = sight.weight > 0.0;
  if (seeks_lamp) {
    contribution = brought * (1.0 - shadow_coverage(at, color.a));
    direction = (1.0 - gl_HitTEXT) * ray;  // up to where the shadow ends, as before
    limit = 1.0;
    shadow_start = behind;
    onwards = direction;
    goes_on = contribution != vec3(0.0);
    sight = to_lamp_with(contribution);
  } else if (holes && !goes_on && contribution != vec3(0.0) && raypool_near_alpha(before, limit * direction)) {
    start = before;
    onwards = limit * direction;
    goes_on = true;
    sight = to_lamp_with(contribution);
  }
  if (goes_on) traceRayEXT(raypool_tree, gl_RayFlagsNoneEXT, 0xffu, 0u, 0u, 0u, start, 0.0, onwards, 1e30, 0);
  if (contribution != vec3(0.0)) {
    traceRayEXT(raypool_tree, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xffu, 0u, 0u, 0u,
                shadow_start, 0.0, direction, limit, 1);
  }
  if (stopped > 0.0) imageStore(raypool_picture, ivec2(pixel), vec4(seen, 1.0));
}
