// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What the preview shows where eye rays meet nothing. A ray that misses runs no shader, so ray generation adds the
// background to every pixel, and a surface adds its own colour less the background: the two backgrounds add up to
// nothing, for the frame buffer adds exactly.
#ifndef BACKGROUND_GLSL
#define BACKGROUND_GLSL

vec3 background(uvec2 pixel) {
  if (raypool_frame.background != vec3(0.0)) return raypool_frame.background;
  const float down = float(pixel.y) * (1.0 / float(raypool_frame.height));
  return mix(vec3(0.22, 0.30, 0.42), vec3(0.55, 0.56, 0.57), down);
}

#endif
