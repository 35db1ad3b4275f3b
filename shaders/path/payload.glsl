// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a path carries from hit to hit: 3 words and 16 bits are all that a ray has room for.
#ifndef PAYLOAD_GLSL
#define PAYLOAD_GLSL

struct Path {
  vec3 weight;       // of what is found, 1 / samples at the eye; TO_LAMP: what the lamp brings
  uint16_t density;  // of the direction, per solid angle: upper half of a float; 0 if no shadow ray can find the same
};
// In place of the density, of which it is none (it would be -0): the ray looks for holes on the path to a lamp.
const uint TO_LAMP = 0x8000u;

float density_of(uint16_t bits) { return uintBitsToFloat(uint(bits) << 16); }
uint16_t density_bits(float density) { return uint16_t(floatBitsToUint(density) >> 16); }

// A way to find a light has the share of its likelihood in that of both ways. Both must have the same bits at the two
// places where shares are computed: so `density` is rounded as it is in the payload.
float share(float density, float likelihood) { return density / (density + likelihood); }
float rounded(float density) { return uintBitsToFloat(floatBitsToUint(max(density, 1e-30)) & 0xffff0000u); }

#endif
