// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Where a shader waits for a ray, and what it still needs when the ray has come back. docs/use/shaders.md.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "shader/module.hpp"

namespace raypool::shader {

/// A traceRayEXT of a shader that goes on behind it.
struct TraceSite {
  uint32_t number = 0;  ///< in its set, from 1: a ray carries it
  const Line* line = nullptr;
  uint32_t block = 0;    ///< its label
  bool in_loop = false;  ///< a thread may come to it again
  /// Values and variables that are read behind it, in order of their ids; the payload's variable is left out.
  std::vector<uint32_t> held;
};

/// Of one shader.
struct Waits {
  std::vector<TraceSite> sites;  ///< in the order of their blocks
  /// Values that are held across a site, and variables.
  std::set<uint32_t> values, variables;
  /// Values that are the same whenever they are computed, and are held across a site or lead to one that is: they are
  /// computed when a kernel begins, in this order.
  std::vector<const Line*> steady;
  /// A payload is read behind a trace, another ray of its kind can follow it, or a miss shader traces: the shader
  /// cannot end with its traces.
  bool needed = false;

  const TraceSite* site(const Line& line) const;
  bool is_steady(const Line& line) const;
};

/// `first`: the number of its first site. The module must outlive the result.
Waits find_waits(const Module& module, uint32_t first = 1);

/// Words that a path's record needs for a value or variable.
uint32_t held_words(const Module& module, uint32_t id);
/// For all that is held across one of the sites.
uint32_t most_held_words(const Module& module, const Waits& waits);

/// gl_RayFlags...EXT
namespace ray_flag {
inline constexpr uint32_t kOpaque = 1, kNoOpaque = 2, kTerminates = 4, kSkipsClosestHit = 8;
inline constexpr uint32_t kCullsBack = 16, kCullsFront = 32, kCullsOpaque = 64, kCullsNoOpaque = 128;
}  // namespace ray_flag
/// Of a ray that asks whether it meets anything.
inline constexpr uint32_t kShadowRay = ray_flag::kTerminates | ray_flag::kSkipsClosestHit;
/// Whether a traceRayEXT has these flags.
bool is_shadow(const Module& module, const Line& trace);

/// The payload's variable of a traceRayEXT, and its type.
uint32_t payload_type(const Module& module, const Line& trace);
inline uint32_t payload_of(const Line& trace) { return trace.operands.at(10); }

/// Whether the shader stores to a buffer.
bool writes_memory(const Module& module);

/// Labels that a block may branch to.
std::vector<uint32_t> successors(const Block& block);

}  // namespace raypool::shader
