// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Random directions and places, for the shader sets that come with raypool. Include it after raypool.glsl.
#ifndef SAMPLING_GLSL
#define SAMPLING_GLSL

// A direction, each as likely as any other; both numbers in 0 .. 1.
vec3 random_direction(float first, float second) {
  float z = 1.0 - 2.0 * first;
  float radius = sqrt(max(1.0 - z * z, 0.0));
  float angle = 6.2831853 * second;
  return vec3(radius * cos(angle), radius * sin(angle), z);
}

// As likely as its cosine with `normal` is large, if `random` is a random_direction(): its density is cosine / pi.
vec3 cosine_direction(vec3 normal, vec3 random) {
  vec3 sum = normal + random;
  return sum * inversesqrt(max(dot(sum, sum), 1e-20));
}

// Where in its pixel this sample's eye ray passes: at the centre if there is one sample, anywhere if there are more.
vec2 place_in_pixel(uint seed) {
  if (raypool_frame.samples == 1u) return vec2(0.0);
  return vec2(raypool_random(seed, 0u) - 0.5, raypool_random(seed, 1u) - 0.5);
}

#endif
