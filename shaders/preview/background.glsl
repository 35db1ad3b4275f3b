// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What the preview shows where eye rays meet nothing. A ray that misses runs no shader, so ray generation adds the
// background to every pixel, and a surface adds only by how much it is brighter: the frame buffer takes nothing away.
// So the background has to be dim.
#ifndef BACKGROUND_GLSL
#define BACKGROUND_GLSL

vec3 background(uvec2 pixel) {
  const float down = float(pixel.y) * (1.0 / float(raypool_frame.height));
  return vec3(0.012, 0.014, 0.018) * (1.0 - 0.6 * down);
}

#endif
