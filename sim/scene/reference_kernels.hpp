// For tests: what the four ray kernels compute, written down directly in float. Independent of the kernel language.
#pragma once

#include <cmath>

#include "bits.hpp"
#include "kernel/kernels.hpp"
#include "scene/vec.hpp"

namespace raypool::reference {

template <typename Words>
Vec3 read3(const Words& words, int first) {
  const size_t i = first;
  return {as_float(words[i]), as_float(words[i + 1]), as_float(words[i + 2])};
}
template <typename Words>
void write3(Words& words, int first, const Vec3& v) {
  for (int axis = 0; axis < 3; ++axis) words[first + axis] = as_bits(v[axis]);
}

inline Vec3 load3(const Memory& memory, uint32_t address) {
  return {as_float(memory.load(address)), as_float(memory.load(address + 4)), as_float(memory.load(address + 8))};
}
inline Vec3 scaled(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

inline void cast_eye(NativeThread& thread) {
  const auto& a = *thread.arguments;
  const uint32_t x = (thread.block & 0xffffu) + (thread.thread & a[argument::kTileMask]);
  const uint32_t y = (thread.block >> 16) + (thread.thread >> a[argument::kTileWidthLog2]);
  if (x >= a[argument::kWidth] || y >= a[argument::kHeight]) return;
  Ray ray{};
  write3(ray, word::kOrigin, read3(a, argument::kEye));
  write3(ray, word::kDirection,
         read3(a, argument::kCorner) + read3(a, argument::kStepX) * static_cast<float>(x) +
             read3(a, argument::kStepY) * static_cast<float>(y));
  ray[word::kLimit] = as_bits(INFINITY);
  ray[word::kPixel] = x | y << 16;
  write3(ray, word::kColor, {1, 1, 1});
  ray[word::kFlags] = 1;
  thread.rays.push_back(ray);
}

inline void cast_secondary(NativeThread& thread, bool reflect) {
  const auto& a = *thread.arguments;
  const Intersection& in = thread.input;
  const Vec3 direction = read3(in, word::kDirection), color = read3(in, word::kColor);
  Vec3 normal = read3(in, word::kNormal);
  float facing = dot(normal, direction);
  if (facing > 0) normal = normal * -1.0f, facing = -facing;
  const float distance = as_float(in[word::kDistance]);
  const Vec3 hit = read3(in, word::kOrigin) + direction * distance;
  const Vec3 point = hit + normal * ((largest_of(hit) + distance) * as_float(a[argument::kOffset]));
  const Vec3 to_light = read3(a, argument::kLight) - point;
  const float cosine = dot(normal, to_light) / std::sqrt(dot(to_light, to_light));
  Ray ray{};
  write3(ray, word::kOrigin, point);
  ray[word::kPixel] = in[word::kPixel];
  if (reflect) {
    const Vec3 throughput = scaled(color, load3(*thread.memory, in[word::kMaterial] + kMaterialReflectance));
    if (throughput.x > 0 || throughput.y > 0 || throughput.z > 0) {
      write3(ray, word::kDirection, direction - normal * (2 * facing));
      ray[word::kLimit] = as_bits(INFINITY);
      write3(ray, word::kColor, throughput);
      ray[word::kFlags] = in[word::kFlags] + 1;
      thread.rays.push_back(ray);
    }
  }
  if (cosine > 0) {
    const Vec3 diffuse = scaled(color, load3(*thread.memory, in[word::kMaterial] + kMaterialDiffuse));
    write3(ray, word::kDirection, to_light);
    ray[word::kLimit] = as_bits(1);
    write3(ray, word::kColor, scaled(diffuse, read3(a, argument::kLightColor)) * cosine);
    ray[word::kFlags] = in[word::kFlags] | kShadowFlag;
    thread.rays.push_back(ray);
  }
}

inline void run(RayKernel kernel, NativeThread& thread) {
  switch (kernel) {
    case RayKernel::CastEye:
      return cast_eye(thread);
    case RayKernel::CastSecondary:
      return cast_secondary(thread, true);
    case RayKernel::CastSecondaryDirect:
      return cast_secondary(thread, false);
    case RayKernel::Shade:
      thread.frame.push_back(
          {thread.input[word::kPixel],
           {thread.input[word::kColor], thread.input[word::kColor + 1], thread.input[word::kColor + 2]}});
  }
}

}  // namespace raypool::reference
