// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What a ray of the preview carries. An eye ray has a weight alone. A ray that looks for holes on the way to the lamp has
// what the lamp brings: red, with its sign set, in place of the weight, green and blue.
#ifndef PAYLOAD_GLSL
#define PAYLOAD_GLSL

struct Sight {
  float weight;  // of what is seen: a surface takes its share, and leaves the rest to those behind it
  float green, blue;
};

const uint SIGN = 0x80000000u;
bool is_to_lamp(Sight sight) { return (floatBitsToUint(sight.weight) & SIGN) != 0u; }
vec3 light_of(Sight sight) { return vec3(abs(sight.weight), sight.green, sight.blue); }
Sight to_lamp_with(vec3 light) {
  return Sight(uintBitsToFloat(floatBitsToUint(light.r) | SIGN), light.g, light.b);
}

#endif
