// The machines with controllers that are compared with their class.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "Vcontroller_1_1_1_1_1_1_1_0_48_8_1_0_0_0_8.h"
#include "Vcontroller_1_64_512_512_512_1_1_0_48_8_64_0_0_0_16.h"
#include "Vcontroller_2_128_40_16_16_1_1_1_48_8_600_0_1_1_8.h"
#include "Vcontroller_2_4_3_9_8_0_1_1_48_8_3_0_1_0_8.h"
#include "Vcontroller_4_2_3_9_6_1_0_0_2_1_4_0_0_1_8.h"
#include "Vcontroller_4_64_512_512_512_1_1_1_48_8_256_1_1_1_8.h"
#include "machine/chip/controller.hpp"
#include "machine/chip/kernel_policy.hpp"
#include "machine/chip/tile_walk.hpp"

namespace raypool::bench {

inline constexpr uint16_t kEyePc = 11, kSecondaryPc = 222, kDirectPc = 3333, kShadePc = 44444;

template <typename Unit_, uint32_t kUnits_, uint32_t kContents_, uint32_t kRays, uint32_t kIntersections,
          uint32_t kHeld, bool kRemedy, bool kAhead, PolicyName kPolicy, uint32_t kRayThreshold,
          uint32_t kIntersectionThreshold, uint32_t kBatch, bool kShades, bool kCulling, TileOrder kOrder,
          uint32_t kExportBits_>
struct Machine {
  using Unit = Unit_;
  static constexpr uint32_t kUnits = kUnits_, kContents = kContents_;
  static constexpr uint32_t kExportBits = kExportBits_;  ///< of a unit's count of exports, as the Verilog has it
  static ChipConfiguration chip() {
    ChipConfiguration chip;
    chip.ray_pool_size = kRays;
    chip.intersection_pool_size = kIntersections;
    chip.held_limit = kHeld;
    chip.window_remedy = kRemedy;
    chip.launch_ahead = kAhead;
    chip.policy = kPolicy;
    chip.thresholds_rays = kRayThreshold;
    chip.thresholds_intersections = kIntersectionThreshold;
    chip.static_traverser_batch = kBatch;
    chip.shading = kShades ? Shading::Traverser : Shading::Kernel;
    chip.culling = kCulling;
    return chip;
  }
  static constexpr TileOrder walk_order() { return kOrder; }
  static TileWalk walk() { return {kOrder, kContents, kHeld}; }
  static std::unique_ptr<KernelPolicy> policy(bool reflections) {
    return make_policy(kPolicy, {kContents, kUnits, kRays, kIntersections, kRayThreshold, kIntersectionThreshold,
                                 kBatch, reflections ? 2u : 1u});
  }
};

using Machines = testing::Types<Machine<Vcontroller_1_64_512_512_512_1_1_0_48_8_64_0_0_0_16, 1, 64, 512, 512, 512, true,
                                        true, PolicyName::Thesis, 48, 8, 64, false, false, TileOrder::Rows, 16>,
                                Machine<Vcontroller_4_64_512_512_512_1_1_1_48_8_256_1_1_1_8, 4, 64, 512, 512, 512, true,
                                        true, PolicyName::Fill, 48, 8, 256, true, true, TileOrder::Hilbert, 8>,
                                Machine<Vcontroller_1_1_1_1_1_1_1_0_48_8_1_0_0_0_8, 1, 1, 1, 1, 1, true, true,
                                        PolicyName::Thesis, 48, 8, 1, false, false, TileOrder::Rows, 8>,
                                Machine<Vcontroller_2_4_3_9_8_0_1_1_48_8_3_0_1_0_8, 2, 4, 3, 9, 8, false, true,
                                        PolicyName::Fill, 48, 8, 3, false, true, TileOrder::Rows, 8>,
                                Machine<Vcontroller_4_2_3_9_6_1_0_0_2_1_4_0_0_1_8, 4, 2, 3, 9, 6, true, false,
                                        PolicyName::Thesis, 2, 1, 4, false, false, TileOrder::Hilbert, 8>,
                                Machine<Vcontroller_2_128_40_16_16_1_1_1_48_8_600_0_1_1_8, 2, 128, 40, 16, 16, true,
                                        true, PolicyName::Fill, 48, 8, 600, false, true, TileOrder::Hilbert, 8>>;

/// A port of a width that depends on the machine.
template <typename Port>
void set(Port& port, uint64_t value) {
  port = static_cast<Port>(value);
}

/// The units' counts of exports, exports(unit), as they stand on the port.
template <typename M, typename Exports>
uint64_t exports_port(const Exports& exports) {
  uint64_t port = 0;
  for (uint32_t unit = M::kUnits; unit-- > 0;)
    port = port << M::kExportBits | (exports(unit) & ((uint64_t{1} << M::kExportBits) - 1));
  return port;
}

/// Levels as they stand on the intersection pool's ports.
template <typename M, typename Unit>
void show_intersections(Unit& u, const Controller::Levels& levels) {
  uint32_t bits = 0;
  for (uint32_t most = M::chip().intersection_pool_size; most != 0; most >>= 1) ++bits;
  uint64_t size = 0, available = 0;
  for (uint32_t k = M::chip().culling ? 3 : 2; k != 0; --k) {
    size = size << bits | levels.size[static_cast<ImportKind>(k)];
    available = available << bits | levels.available[static_cast<ImportKind>(k)];
  }
  set(u.size_i, size);
  set(u.available_i, available);
}

}  // namespace raypool::bench
