// A frame: what a chip draws it with, and what comes of it. docs/machine/chip.md describes the chip,
// docs/machine/deadlock.md why it cannot deadlock.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "chip/ports.hpp"
#include "chip/tile_costs.hpp"
#include "chip/tree_image.hpp"
#include "config/configuration.hpp"
#include "isa/isa.hpp"
#include "kernel/kernels.hpp"
#include "machine/common/memory.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/compute/warp_cycles.hpp"
#include "machine/traverser/traverser_work.hpp"
#include "machine/traverser/tree_fault.hpp"
#include "scene/ray_counts.hpp"

namespace raypool {

namespace chip {
class ExternalTraverser;
}

struct ChipProgress {
  double pixels_done = 0;  ///< share of the image's pixels that have been cast, 0 .. 1
  uint64_t cycles = 0;
  uint64_t rays = 0;  ///< traced
};

/// When to give up a run in which something is still done.
struct RunLimits {
  uint64_t cycles = 0;  ///< so many; 0: never. Of a program on an engine without time: warp instructions
  /// So many cycles in which instructions end and nothing else happens, as in a program without end; 0: never. By
  /// default 10 million, unless `cycles` limits the run.
  std::optional<uint64_t> silent_cycles;

  uint64_t silent() const { return silent_cycles.value_or(cycles == 0 ? 10'000'000 : 0); }
};

struct ChipOptions {
  Configuration configuration;                            ///< of the unit and of the chip
  bool timed = true;                                      ///< the chip's units have a notion of time
  Memory* memory = nullptr;                               ///< program and materials
  uint32_t program_length = 0;                            ///< instructions, from address 0
  EnumArray<RayKernel, uint32_t, kRayKernels> entries{};  ///< PC of each
  RecordLayout layout;   ///< of the intersections that the program imports; `configuration` has how many words
  bool shaders = false;  ///< kernels are of a shader set: they export what they like
  /// Words kTileWidthLog2, kTileMask, kWidth and kHeight are set by the chip, whatever they hold.
  std::array<uint32_t, kArguments> arguments{};
  uint32_t width = 0, height = 0;  ///< pixels, 1 .. 65535
  uint32_t depth = 1;              ///< 1: eye and shadow rays only; up to kLargestDepth (scene/native_renderer.hpp)
  bool reflections = true;  ///< false: casts none, whatever the depth; the same picture where no material reflects
  RayTracer* tracer = nullptr;
  /// At the ports of a chip without one inside (external_traverser.hpp), which then needs no tracer; null: the one of
  /// constant speed.
  chip::ExternalTraverser* traverser = nullptr;
  TreeImage* tree = nullptr;  ///< of a traverser in hardware, which needs no tracer; its stacks are written
  FrameSink* frame = nullptr;

  /// Numbers along the tile walk (machine/chip/tile_walk.hpp) of those that are cast, ascending; empty: all of the
  /// picture.
  std::vector<uint32_t> tiles;
  chip::TileCosts* tile_costs = nullptr;  ///< gets what each of them costs; may be null
  /// What rays have visited of the tree, last what they visited last, when this tile of `tiles` is cast and its
  /// predecessor is not: the caches of a traverser inside then hold it, and that takes no time. Asked together with
  /// `tile_costs` only; may be empty.
  std::function<VisitList(uint32_t tile)> visited_before;

  std::function<void(const ChipProgress&)> progress;  ///< called now and then, and at the end
  /// So many cycles in which nothing is done, and nothing is due, are an error; 0: never looked at.
  uint64_t watchdog_cycles = 100'000;
  RunLimits limits;
};

/// What bounds a run: the Mrays/s at which this would be busy in every cycle, everything else being as it was.
struct Ceiling {
  std::string name;
  double mrays_per_s;
};

/// The fill of a pool over the run.
struct PoolFill {
  uint32_t capacity = 0;
  uint32_t peak = 0;
  double mean = 0;  ///< over time
};

struct ChipResult {
  bool timed =
      true;  ///< false: the engine has no notion of time, and cycles and all that is made from them mean nothing
  uint64_t cycles = 0;  ///< of 1 ns, from reset until everything is idle
  double nanoseconds = 0;
  double wall_seconds = 0;
  // 0 when untimed.
  double mrays_per_s = 0;         ///< rays traced / time
  double thesis_mrays_per_s = 0;  ///< as the thesis counts: at depth 1 an eye and a shadow ray a pixel, traced or not
  double frames_per_s = 0;        ///< 1 / time

  // Rays.
  RayCounts ray_counts;
  uint64_t rays() const { return ray_counts.traced(); }
  uint64_t dropped_depth = 0;  ///< rays beyond the depth limit; never traced, with chip.culling never cast
  uint64_t contributions = 0;  ///< to the frame buffer

  struct Kernel {
    uint64_t launches = 0;
    uint64_t threads = 0;  ///< launched
    uint64_t cycles = 0;   ///< running, summed over the units
  };
  EnumArray<RayKernel, Kernel, kRayKernels> kernels{};

  // The multiprocessor: averages over the units. Shares are 0 .. 1.
  double time_utilisation = 0;      ///< busy time / total time
  double resource_utilisation = 0;  ///< threads launched / threads launchable, weighted by kernel time
  struct Alu {
    double utilisation = 0;  ///< 1 - share of busy time in which an instance was free for a new task and got none
    double waiting = 0;      ///< warps that wanted this type and were not granted, averaged over busy time
    uint64_t issued = 0;     ///< tasks
  };
  EnumArray<AluType, Alu, kAluTypes> alus{};
  uint64_t busy_cycles = 0, instructions = 0, thread_instructions = 0;
  WarpCycles warp_cycles;
  uint64_t warp_cycles_without_kernel = 0;
  std::vector<Ceiling> ceilings;  ///< the lowest first; of what was busy at all
  uint64_t instruction_cache_hits = 0, instruction_cache_misses = 0;
  uint64_t data_cache_hits = 0, data_cache_misses = 0, data_cache_stores = 0;

  // Pools and ports. A port's utilisation is the share of time in which it serves a request.
  PoolFill rays_pool, normal_pool, shadow_pool, direct_pool;
  double ray_port_utilisation = 0, intersection_port_utilisation = 0, memory_port_utilisation = 0;
  uint64_t memory_reads = 0;             ///< lines of 64 bytes
  uint64_t memory_writes = 0;            ///< quadwords of 16 bytes
  uint64_t traverser_batches = 0;        ///< at a kernel's end
  uint64_t traverser_stall_batches = 0;  ///< after a stall of the shader

  std::optional<TraverserWork> traversal;  ///< of a traverser with a machine inside
};

/// A unit stopped with a fault. what() has unit, fault, place and meaning.
struct ChipFault : InputError {
  ChipFault(uint32_t unit_number, const Fault& what_fault, const std::string& message)
      : InputError(message), unit(unit_number), fault(what_fault) {}
  uint32_t unit;
  Fault fault;
};

/// The traverser in the chip stopped with a fault: its memory does not hold a tree. what() has what is wrong, where,
/// and what to do.
struct TraverserFault : InputError {
  TraverserFault(const TreeFault& what_fault, const std::string& message) : InputError(message), fault(what_fault) {}
  TreeFault fault;
};

/// Nothing moves any more, or a limit has passed. what() reports what waits for what.
struct ChipStalled : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One of the RunLimits has passed, and the run might have ended later.
struct LimitPassed : ChipStalled {
  /// `passed`: which one; `state`: what waits for what.
  LimitPassed(const std::string& passed, const std::string& state)
      : ChipStalled(passed + "; " + state), limit(passed), rest(state) {}
  std::string limit, rest;
};

/// One sentence: code, its meaning, unit, warp and PC.
std::string fault_sentence(uint32_t unit, const Fault& fault);

}  // namespace raypool
