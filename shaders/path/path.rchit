#version 460
// One step of a path. The surface is metallic-roughness as glTF defines it: of its parts (cut out, glass, highlight,
// matt) a random number chooses the one that the path follows. A shadow ray finds the same light more directly: how
// likely each way is decides its share (multiple importance sampling with the balance heuristic).
//
// A shadow ray ends at the first triangle, even where that has a hole. So that lamps shine through holes, the path's own
// ray goes to the lamp now and then in place of going on (TO_LAMP). At each hole it sends a shadow ray that looks
// whether the rest of the way is free, and goes on behind it. Scenes without holes have no code for that.
#extension GL_EXT_ray_tracing : require
#extension GL_GOOGLE_include_directive : require
#include "raypool.glsl"
#include "sampling.glsl"
#include "payload.glsl"

// Paths of more segments may end by chance, more likely the less they weigh.
layout(constant_id = 0) const uint sure_depth = 3u;

layout(location = 0) rayPayloadInEXT Path path;
layout(location = 1) rayPayloadEXT vec3 contribution;
hitAttributeEXT RaypoolHit hit;

const float pi = 3.14159265;

// Each has a random number of its own.
const uint RANDOM_PART = 0u;
const uint RANDOM_SIDE = 1u;
const uint RANDOM_DIRECTION = 2u;  // and 3
const uint RANDOM_LIGHT = 4u;
const uint RANDOM_PLACE = 5u;  // and 6
const uint RANDOM_SKY = 7u;
const uint RANDOM_END = 8u;
const uint RANDOM_SLOPE = 9u;  // and 10
const uint RANDOM_WAY = 11u;

vec3 random_of(uint seed, uint which) {
  return random_direction(raypool_random(seed, which), raypool_random(seed, which + 1u));
}

float largest(vec3 v) { return max(max(v.x, v.y), v.z); }

// Of what is reflected at this cosine, by Schlick; `straight` is reflected at cosine 1.
vec3 fresnel(vec3 straight, float cosine) {
  const float rest = 1.0 - min(cosine, 1.0);
  const float square = rest * rest;
  return straight + (1.0 - straight) * (square * square * rest);
}

// The same for glass, exactly: cosines before and behind, and the ratio of the indices of refraction.
float glass_fresnel(float before, float behind, float ratio) {
  const float across = (ratio * before - behind) / (ratio * before + behind);
  const float along = (before - ratio * behind) / (before + ratio * behind);
  return 0.5 * (across * across + along * along);
}

// GGX, the distribution of a rough surface's slopes, has this width. Makes a direction narrower about the normal, by
// which a wide hemisphere becomes slopes.
vec3 squeeze(vec3 direction, vec3 normal, float width) {
  return normalize(mix(dot(direction, normal) * normal, direction, width));
}

float ggx_root(float cosine, float width) {
  const float square = width * width;
  return cosine + sqrt((1.0 - square) * (cosine * cosine) + square);
}

// The share of light at this cosine that slopes do not hide.
float ggx_visible(float cosine, float width) { return 2.0 * cosine / ggx_root(cosine, width); }

// Density, per solid angle, of reflections about the slopes that the viewer sees: `slope` and `viewer` are cosines
// with the normal.
float ggx_density(float slope, float viewer, float width) {
  const float square = width * width;
  const float bulge = 1.0 - (1.0 - square) * (slope * slope);
  return square / (2.0 * pi * bulge * bulge * ggx_root(viewer, width));
}

// A slope that the viewer sees, from a random_direction(). Seen with a narrower view, slopes are those of a hemisphere:
// there the halves between the view and the points of a spherical cap are as likely as they are seen. The random
// direction's height is as likely as any, and becomes one of the cap's heights.
vec3 ggx_slope(vec3 viewer, vec3 normal, float width, vec3 random) {
  const vec3 view = squeeze(viewer, normal, width);
  const float low = -dot(view, normal);
  const float height = dot(random, normal);
  const float cap_height = low + (0.5 * height + 0.5) * (1.0 - low);
  const float wider = sqrt(max(1.0 - cap_height * cap_height, 0.0) / max(1.0 - height * height, 1e-12));
  return squeeze(wider * (random - height * normal) + cap_height * normal + view, normal, width);
}

void main() {
  const uvec2 pixel = gl_LaunchIDEXT.xy;
  const uint seed = raypool_seed(pixel, hit.depth);
  const uint triangle = uint(gl_PrimitiveID);
  const vec3 ray = gl_WorldRayDirectionEXT;  // of unit length: each ray of a path is
  const bool behind = dot(ray, hit.normal) > 0.0;
  const vec3 face = behind ? -hit.normal : hit.normal;

  // Read where it is needed, so that registers need not hold it.
  RaypoolMaterialAt at = RaypoolMaterialAt(uvec2(raypool_record(hit.material).material, 0u));
  const vec2 texcoord = raypool_texcoord(triangle, hit.barycentrics);
  const bool sky = raypool_frame.background != vec3(0.0);
  const bool holes = raypool_frame.alpha_radius > 0.0;
  const bool to_lamp = holes && uint(path.density) == TO_LAMP;

  // What the path finds. A light that a shadow ray could have found as well counts by its share.
  vec3 found = to_lamp ? vec3(0.0) : path.weight * at.material.emission;
  if (found != vec3(0.0)) {
    found *= raypool_texture(at.material.emission_texture, texcoord).rgb;
    const float density = density_of(path.density);
    if (density > 0.0) {
      found *= share(density, raypool_light_likelihood(ray, gl_HitTEXT, hit.normal, at.material.emission,
                                                       at.material.emission_texture));
    }
  }

  // The surface.
  vec4 color = raypool_color(triangle, hit.barycentrics) * vec4(at.material.base_color, at.material.alpha);
  if (at.material.base_color_texture != 0u) color *= raypool_texture(at.material.base_color_texture, texcoord);
  vec3 normal = raypool_normal(triangle, hit.barycentrics);
  if (dot(normal, face) < 0.0) normal = -normal;
  if (dot(normal, ray) >= 0.0) normal = face;
  const float viewer = clamp(-dot(normal, ray), 1e-4, 1.0);

  float coverage = 1.0;
  if (at.material.alpha_mode == RAYPOOL_CUT_OUT) coverage = color.a < at.material.alpha_cutoff ? 0.0 : 1.0;
  if (at.material.alpha_mode == RAYPOOL_BLEND) coverage = color.a;

  // Where the path goes on, and with what.
  vec3 bounce = ray;
  vec3 passed = vec3(1.0);
  float bounce_density = 0.0;
  bool leaves = true;  // on the side from which the ray came
  // And what the shadow ray brings: the sky from where the path goes on to, or a light.
  vec3 shadow_direction = vec3(0.0);
  float shadow_limit = 1.0;
  bool to_sky = sky && !to_lamp;
  float sky_share = 1.0;
  bool through_holes = false;  // may the light come
  contribution = vec3(0.0);

  const float part = raypool_random(seed, RANDOM_PART);
  if (to_lamp) {
    leaves = false;
    passed = vec3(1.0 - coverage);
    bounce = (1.0 - gl_HitTEXT) * ray;  // up to the lamp, as before
    contribution = path.weight * passed;
    shadow_direction = bounce;
  } else if (part >= coverage) {
    leaves = false;  // straight on
  } else if (part < coverage * at.material.transmission) {
    const float ratio = behind ? at.material.ior : 1.0 / at.material.ior;
    const float squared = 1.0 - ratio * ratio * (1.0 - viewer * viewer);
    const float inside = sqrt(max(squared, 0.0));
    if (raypool_random(seed, RANDOM_SIDE) < glass_fresnel(viewer, inside, ratio)) {
      bounce = ray + 2.0 * viewer * normal;
    } else {
      bounce = ratio * ray + (ratio * viewer - inside) * normal;
      passed = color.rgb;
      leaves = false;
    }
  } else {
    float metallic = at.material.metallic;
    float roughness = at.material.roughness;
    if (at.material.metallic_roughness_texture != 0u) {
      const vec4 texel = raypool_texture(at.material.metallic_roughness_texture, texcoord);
      metallic *= texel.b;
      roughness *= texel.g;
    }
    const float width = max(roughness * roughness, 0.01);
    const vec3 straight = mix(vec3(0.04), color.rgb, metallic);
    const vec3 slope = ggx_slope(-ray, normal, width, random_of(seed, RANDOM_SLOPE));
    const float straightness = max(-dot(ray, slope), 0.0);
    const vec3 mirrored = ray + 2.0 * straightness * slope;
    const float visible = ggx_visible(max(dot(mirrored, normal), 0.0), width);
    // What such slopes do not reflect goes into the surface: on average over slopes, all that the highlight leaves.
    const vec3 matt = (1.0 - metallic) * (1.0 - fresnel(vec3(0.04), straightness).x * visible) * color.rgb;

    const float reflected = largest(fresnel(straight, viewer));
    const float shine = reflected / max(reflected + (1.0 - metallic) * (1.0 - reflected) * largest(color.rgb), 1e-6);
    if (raypool_random(seed, RANDOM_SIDE) < shine) {
      bounce = mirrored;
      passed = fresnel(straight, straightness) * (visible / shine);
      bounce_density = rounded(shine * ggx_density(dot(slope, normal), viewer, width));
    } else {
      bounce = cosine_direction(normal, random_of(seed, RANDOM_DIRECTION));
      passed = matt / (1.0 - shine);
      bounce_density = rounded((1.0 - shine) / pi * max(dot(bounce, normal), 0.0));
    }
    if (dot(bounce, face) <= 0.0) passed = vec3(0.0);

    // With a sky, every other shadow ray goes to a light.
    if (sky) {
      to_sky = raypool_random(seed, RANDOM_SKY) < 0.5;
      sky_share = 2.0;
    }
    if (!to_sky) {
      const vec3 point = gl_HitTEXT * ray + gl_WorldRayOriginEXT;
      const RaypoolLit lit =
          raypool_light(raypool_choose_light(raypool_random(seed, RANDOM_LIGHT)), point,
                        vec2(raypool_random(seed, RANDOM_PLACE), raypool_random(seed, RANDOM_PLACE + 1u)));
      const vec3 to_light = normalize(lit.direction);
      const float cosine = dot(to_light, normal);
      if (cosine > 0.0 && dot(to_light, face) > 0.0) {
        const vec3 half_way = normalize(to_light - ray);
        const float shine_density = ggx_density(dot(half_way, normal), viewer, width);
        vec3 shine_light = fresnel(straight, dot(to_light, half_way)) * (shine_density * ggx_visible(cosine, width));
        vec3 matt_light = matt * (cosine / pi);
        // No ray goes on from the last hit, so the light is found in this way alone.
        if (lit.likelihood > 0.0 && hit.depth < raypool_frame.depth) {
          shine_light *= share(lit.likelihood, rounded(shine * shine_density));
          matt_light *= share(lit.likelihood, rounded((1.0 - shine) * (cosine / pi)));
        }
        contribution = path.weight * (shine_light + matt_light) * lit.irradiance * sky_share;
        shadow_direction = lit.direction;
        // The light's own triangle does not hide it.
        if (lit.likelihood > 0.0) shadow_limit = 0.9995;
        // Lamps that are triangles are found behind holes by chance. The last ray meets nothing more.
        through_holes = holes && lit.likelihood == 0.0 && hit.depth < raypool_frame.depth &&
                        raypool_near_alpha(point, lit.direction);
      }
    }
  }

  path.weight *= passed;
  path.density = to_lamp ? uint16_t(TO_LAMP) : density_bits(bounce_density);
  if (to_sky) {
    contribution = path.weight * raypool_frame.background * sky_share;
    shadow_direction = bounce;
    shadow_limit = 1e30;
  }

  float going_on = largest(path.weight);
  if (!to_lamp && hit.depth >= sure_depth) {
    const float keep = min(going_on * float(raypool_frame.samples), 1.0);
    if (raypool_random(seed, RANDOM_END) < keep) {
      path.weight /= keep;
    } else {
      going_on = 0.0;
    }
  }

  // Every other ray goes to the lamp, and every ray where the path ends. Each counts for those that go the other way.
  if (holes && through_holes && contribution != vec3(0.0)) {
    const float chance = going_on > 0.0 ? 0.5 : 1.0;
    if (raypool_random(seed, RANDOM_WAY) < chance) {
      path.weight = contribution / chance;
      path.density = uint16_t(TO_LAMP);
      bounce = shadow_direction;
      going_on = 1.0;
    } else {
      path.weight *= 2.0;
    }
  }

  // Nothing of the hit is needed after the first ray has left, so nothing of it has to be kept.
  const vec3 origin =
      raypool_offset_origin(gl_WorldRayOriginEXT, gl_WorldRayDirectionEXT, gl_HitTEXT, leaves ? face : -face);
  if (going_on > 0.0) traceRayEXT(raypool_tree, gl_RayFlagsNoneEXT, 0xffu, 0u, 0u, 0u, origin, 0.0, bounce, 1e30, 0);
  if (contribution != vec3(0.0)) {
    traceRayEXT(raypool_tree, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xffu, 0u, 0u, 0u,
                origin, 0.0, shadow_direction, shadow_limit, 1);
  }
  if (found != vec3(0.0)) imageStore(raypool_picture, ivec2(pixel), vec4(found, 1.0));
}
