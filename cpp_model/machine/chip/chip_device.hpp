// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The chip's interface: one set of ports, behind which stand its model, the Verilated rtl/chip/rp_chip.v and the
// lockstep of both. Outside remain the memory, the frame buffer, a host that starts a frame, and a traverser at its
// ports, unless one is inside.
//
// Use, once a cycle: read outputs() (what the ports show in this cycle; they never depend on this cycle's inputs),
// decide the inputs, call clock(inputs). A handshake transfers when both its valid and its ready are set in the same
// cycle. Names are those of rtl/chip/rp_chip.v without _i and _o; docs/machine/ has the protocols.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "isa/isa.hpp"
#include "machine/chip/memory_port.hpp"
#include "machine/chip/ray_kernel.hpp"
#include "machine/common/memory.hpp"
#include "machine/common/packages.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/traverser/traverser_work.hpp"
#include "machine/traverser/tree_fault.hpp"
#include "machine/traverser/tree_setup.hpp"

namespace raypool {

/// Whether rtl/traverser/rp_traverser.v is in rtl/chip/rp_chip.v: then what stays for a frame includes where its tree
/// is. Otherwise a traverser may be at the chip's ports.
constexpr bool has_traverser(const ChipConfiguration& chip) { return chip.traverser == TraverserName::Hardware; }

/// What stays for a frame; a host writes it before it starts one.
struct FrameSetup {
  uint32_t program_length = 0;  ///< instructions, from address 0; until the next reset
  uint32_t memory_limit = 0;    ///< bytes; likewise
  std::array<uint32_t, kArguments> arguments{};
  EnumArray<RayKernel, uint32_t, kRayKernels> entries{};  ///< PC of each
  uint32_t width = 0, height = 0;                         ///< pixels, 1 .. 65535
  uint32_t depth = 1;                                     ///< of normal rays: deeper ones are dropped
  bool reflections = false;                               ///< normal intersections are for the kernel that reflects
  TreeSetup tree;                                         ///< of a traverser inside
  /// Of a model alone: numbers of the tiles that are cast, counted along their walk, ascending; the others take no
  /// time. Empty: all. Throws std::logic_error in Verilog.
  std::vector<uint32_t> tiles;
};

/// How a frame begins: after a reset of the chip, or as the next one, once nothing of the one before is left in it.
enum class FrameBegin : uint8_t { Reset, Next };

/// What a traverser shows: of its rays, what becomes of them, and its memory.
struct TraverserPorts {
  bool ray_ready = false;
  bool free_valid = false;
  uint32_t free_place = 0;
  bool free_shadow = false;
  bool put_valid = false;
  ImportKind put_kind = ImportKind::None;
  Beat put_data{};
  bool contribution_valid = false;
  FrameContribution contribution;
  bool tree_request_valid = false;
  TreeRequest tree_request;
};

/// Those of a traverser are for one at the chip's ports.
struct ChipInputs : TraverserPorts {
  bool start = false;  ///< the host asks for a frame once more, of what stays for it; refused where ready is not set
  // memory
  bool memory_request_ready = false;
  bool memory_beat_valid = false;
  Beat memory_beat_data{};
  // frame buffer
  bool frame_ready = false;
};

/// What goes with a valid means something only while it is set; masks have one bit a unit.
struct ChipOutputs {
  bool ready = false;  ///< nothing of a frame is left inside: the next one may begin; stays until it does
  bool busy = false;   ///< a frame is being drawn

  // memory
  bool memory_request_valid = false;
  MemoryPort::Access memory_request;
  bool memory_beat_ready = false;
  // frame buffer
  bool frame_valid = false;
  FrameContribution frame;
  // traverser, inside or at the ports
  bool ray_valid = false, ray_last = false;
  uint32_t ray_place = 0;
  Beat ray_data{};
  uint32_t put_ready = 0;  ///< mask: bit of ImportKind
  bool contribution_ready = false;
  bool tree_request_ready = false;
  bool tree_response_valid = false;
  uint8_t tree_response_beat = 0;  ///< 0 .. 3 within the line
  Beat tree_response_data{};

  // Between the blocks. Nothing there depends on this cycle's inputs either.
  UnitInputs to_device;  ///< of the multiprocessor
  UnitOutputs device;
  struct Outcome {
    bool valid = false, kept = false, deep = false, shadow = false, eye = false;
    uint8_t unit = 0;
    uint32_t pixel = 0;
  } outcome;
  uint32_t rays = 0, shadow_rays = 0;                                 ///< in the ray pool, and among them
  bool held_up = false;                                               ///< a ray that is offered waits for room
  EnumArray<ImportKind, uint32_t, kImportKinds> size{}, available{};  ///< of the intersection pool
  bool reserve_valid = false;
  ImportKind reserve_kind = ImportKind::None;
  uint32_t reserve_count = 0;
  bool pixel_valid = false;  ///< the pixel of a package that leaves the intersection pool is shown
  uint8_t pixel_unit = 0;
  bool exported_valid = false;  ///< the frame port has taken a contribution of a unit
  uint8_t exported_unit = 0;
  uint32_t exported_pixel = 0;
  uint32_t quiet = 0;        ///< mask: nothing of the unit waits or is on its way at the memory port
  TraverserPorts traverser;  ///< of one inside
  TreeFault tree_fault;      ///< likewise
  /// Of one inside, where rays visit for long without a transfer at a port: lanes that its caches give a line, a bit
  /// each, and with triangles one above them for its exit. kNotSeen: where only ports can be seen.
  uint32_t nodes_given = 0, leaves_given = 0;
  static constexpr uint32_t kNotSeen = UINT32_MAX;
};

/// For the report: since the last reset, right two cycles after the last event.
struct ChipCounts {
  uint64_t rays_taken = 0, ray_port_busy = 0;  ///< dropped rays too; cycles
  uint64_t packages_taken = 0;
  uint64_t contributions = 0;
  uint64_t memory_reads = 0, memory_writes = 0, memory_port_busy = 0;  ///< lines and quadwords of the device; cycles

  /// What has been counted since `before`.
  ChipCounts operator-(const ChipCounts& before) const {
    return {rays_taken - before.rays_taken,
            ray_port_busy - before.ray_port_busy,
            packages_taken - before.packages_taken,
            contributions - before.contributions,
            memory_reads - before.memory_reads,
            memory_writes - before.memory_writes,
            memory_port_busy - before.memory_port_busy};
  }
};

class ChipDevice {
 public:
  virtual ~ChipDevice() = default;

  virtual uint32_t units() const = 0;
  /// Resets, writes what stays for a frame, and starts it: the frame begins in the first cycle that is clocked.
  virtual void start(const FrameSetup& setup) = 0;
  /// The same without a reset, for the next frame: of the memories, which may hold another scene, nothing is
  /// remembered. Takes a cycle for each argument. Throws std::logic_error while outputs().ready is not set, or where
  /// program length or memory limit are not those of the last start().
  virtual void start_next(const FrameSetup& setup) = 0;
  virtual const ChipOutputs& outputs() const = 0;
  virtual void clock(const ChipInputs& inputs) = 0;
  /// Clocks at least once and at most `cycles` times, and returns how often. What is valid at the inputs is so in the
  /// first cycle only, the readies stay. It ends early when in the next cycle something may be transferred, outputs()
  /// change, or an engine cannot rule that out: in all but the first nothing but the units works.
  virtual uint64_t run(const ChipInputs& inputs, uint64_t cycles);
  /// Call it before you look at signals inside: they then show what a cycle with these inputs comes to, which clock()
  /// ends.
  virtual void settle(const ChipInputs& inputs);

  virtual ChipCounts counts() = 0;
  virtual uint64_t counter(int number) = 0;  ///< of the units, summed; see namespace counter
  /// What a traverser inside has done since the last frame began; nothing where only ports can be seen.
  virtual std::optional<TraverserWork> traverser_work() const;
  /// Writes a waveform from now on; throws std::runtime_error where there is none.
  virtual void open_waveform(const std::string& path);
  /// A signal of the instance `scope` (such as "gen_inside.traverser"); the list chip_probes.vlt has those there are.
  virtual Signal signal(const std::string& scope, const std::string& name) const;

 protected:
  /// Throws what start_next() does.
  static void check_next(const FrameSetup& before, const FrameSetup& setup, const ChipOutputs& outputs);
};

}  // namespace raypool
