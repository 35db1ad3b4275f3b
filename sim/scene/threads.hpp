// How many threads draw.
#pragma once

#include <algorithm>
#include <cstdint>
#include <thread>

#include "scene/native_renderer.hpp"

namespace raypool {

/// `asked`, or if that is 0 as many as the machine has cores, if a frame may have so many.
inline uint32_t threads_or_all(uint32_t asked = 0) {
  if (asked != 0) return asked;
  return std::min(std::max(1u, std::thread::hardware_concurrency()), kMostRenderThreads);
}

}  // namespace raypool
