// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_ray_alu.v, cycle by cycle, without data: the tasks of the ray ALU, and which set is a warp's
// input, current and output. The words of the local ray memory are the functional core's.
// docs/machine/ray-alu.md gives the rules that both sides follow.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "bits.hpp"
#include "config/configuration.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/compute/decoder.hpp"
#include "machine/compute/ray_export.hpp"
#include "machine/compute/ray_import.hpp"
#include "machine/compute/ray_memory.hpp"

namespace raypool {

class RayAlu {
 public:
  /// A task of a warp, from its issue to its end.
  struct Task {
    Opcode opcode = Opcode::Rin;
    bool illegal = false;  ///< rld or rst of a word that an intersection has not
    uint32_t mask = 0;

    bool access() const { return opcode == Opcode::Rld || opcode == Opcode::Rst; }
  };
  /// Which set is a warp's input, current and output.
  struct Roles {
    uint8_t input = 0, current = 1, output = 2;
  };
  struct Registers {
    bool hold = false;  ///< steps of an access are left
    uint32_t step = 0;  ///< 0 while nothing is held
    uint32_t hold_warp = 0;
    uint8_t hold_set = 0;
    bool hold_write = false;
    bool result = false, result_last = false;  ///< the cycle before had a step, the last one
    uint32_t parked_in = 0, parked_out = 0;    ///< warps with a rin; with a rout or rfb
    bool done = false, trace = false;          ///< trace: the task that is done is an rst
    uint32_t done_warp = 0;
    bool fault = false;  ///< ray word that an intersection has not
    uint32_t fault_warp = 0;
    uint16_t exports = 0;  ///< lanes of all rout and rfb that have arrived
  };

  /// `slices` must outlive it.
  RayAlu(const Configuration& configuration, const RaySlices& slices);

  void reset();

  /// The instruction is the warp's task, before it arrives; `illegal`: an intersection has not the ray word.
  void begin(uint32_t warp, const DecodedInstruction& instruction, uint32_t mask, bool illegal) {
    tasks_[warp] = {instruction.opcode, illegal, mask};
  }

  // Outputs of the present cycle.
  /// Whether a task granted in this cycle is taken; `arriving` as for clock().
  bool ready(int arriving) const {
    const bool write = import_.registers().write;
    if (q_.hold) return q_.step == last_step_ && !(write && import_.registers().write_set == q_.hold_set);
    return arriving < 0 || !(tasks_[arriving].access() && (last_step_ > 0 || write));
  }
  /// False if clock() would change nothing: it need not be called as long as no task, no import and no beat arrives.
  bool active() const { return next_.access | (next_.swaps != 0) | next_.import | next_.exports; }
  uint32_t done() const { return uint32_t{q_.done} << q_.done_warp; }  ///< the warp with a task that is done, as a bit
  bool wrote() const { return q_.trace; }                              ///< that task was an rst
  bool fault() const { return q_.fault; }
  uint32_t fault_warp() const { return q_.fault_warp; }
  bool import_active() const { return import_.registers().active; }
  ImportKind import_kind() const { return import_.registers().request_kind; }
  /// An import is under way, or beats wait or are still to be read.
  bool moves_rays() const { return import_active() || export_.exporting(); }
  /// Whether a rin, rout or rfb waits, and those that wait for a package, or for the one before to leave.
  bool parked() const { return (q_.parked_in | q_.parked_out) != 0; }
  uint32_t import_wait() const { return q_.parked_in & ~import_.registers().full; }
  uint32_t export_wait() const { return q_.parked_out & export_.registers().busy; }
  /// The valids of its ports, as namespace signal has them.
  uint32_t signals() const {
    return import_.registers().request_valid * signal::kImportRequest | export_.export_valid() * signal::kExport |
           export_.frame_valid() * signal::kFrame;
  }
  /// The beat that is offered.
  const RayExport::Beat& beat() const { return export_.offered(); }

  const Registers& registers() const { return q_; }
  const Roles& roles(uint32_t warp) const { return roles_[warp]; }
  const RayImport& import() const { return import_; }
  const RayExport& exports() const { return export_; }

  /// `arriving`: the warp with a task that arrives in this cycle, or -1; `import_start`: of the launch that is accepted
  /// in it. Returns the warp that executes its rin, rout or rfb at the end of this cycle, or -1.
  int clock(int arriving, ImportKind import_start, const UnitInputs& inputs);

 private:
  /// What the next clock() has to do.
  struct Plan {
    uint32_t swaps = 0;  ///< warps that can execute their rin, rout or rfb
    bool access = false, import = false, exports = false;
  };
  void plan();
  bool clock_access(int arriving, RayMemory& memory);
  void clock_engines(ImportKind import_start, const UnitInputs& inputs, RayMemory& memory);
  void swap(uint32_t warp);
  void park(uint32_t warp);

  uint32_t last_step_;
  std::array<Task, kMostWarps> tasks_{};
  std::array<Roles, kMostWarps> roles_{};
  Registers q_;
  RayImport import_;
  RayExport export_;
  Plan next_;
};

// Inline, as they are part of every cycle of the engine.

inline RayAlu::RayAlu(const Configuration& configuration, const RaySlices& slices)
    : last_step_(configuration.ray_access_cycles() - 1), import_(configuration), export_(slices) {}

inline void RayAlu::reset() {
  roles_.fill(Roles{});
  q_ = Registers{};
  import_.reset();
  export_.reset();
  next_ = Plan{};
}

inline int RayAlu::clock(int arriving, ImportKind import_start, const UnitInputs& inputs) {
  const uint32_t ready_swaps = next_.swaps;
  RayMemory memory;
  memory.grant(import_.registers().write, import_.registers().write_set);
  const bool result_end = (next_.access | (arriving >= 0)) && clock_access(arriving, memory);
  // The engines see the roles of this cycle, so a swap comes after them.
  clock_engines(import_start, inputs, memory);

  // One swap a cycle; the done port goes to an access first.
  const int swapped = ready_swaps != 0 && !result_end ? static_cast<int>(lowest(ready_swaps)) : -1;
  if (swapped >= 0) {
    q_.done = true;
    q_.done_warp = static_cast<uint32_t>(swapped);
    swap(q_.done_warp);
  }
  if (arriving >= 0) park(static_cast<uint32_t>(arriving));
  plan();
  return swapped;
}

// An access makes a step a cycle, the first one as it arrives; true in the cycle after its last.
inline bool RayAlu::clock_access(int arriving, RayMemory& memory) {
  const bool result_end = q_.result && q_.result_last;
  q_.done = result_end;
  q_.trace = result_end && q_.hold_write;
  q_.done_warp = q_.hold_warp;

  if (arriving >= 0) {
    const Task& task = tasks_[arriving];
    q_.fault = task.illegal;
    q_.fault_warp = static_cast<uint32_t>(arriving);
    if (task.access() && !q_.fault) {
      q_.hold = true;
      q_.hold_warp = q_.fault_warp;
      q_.hold_set = roles_[q_.hold_warp].current;
      q_.hold_write = task.opcode == Opcode::Rst;
    }
  } else {
    q_.fault = false;
  }
  const bool last = q_.step == last_step_;
  q_.result = memory.grant(q_.hold, q_.hold_set);
  if (q_.result) {
    q_.result_last = last;
    q_.hold = !last;
    q_.step = last ? 0 : q_.step + 1;
  }
  return result_end;
}

// Asked for several times in a cycle, so worked out once.
inline void RayAlu::plan() {
  next_.swaps = (q_.parked_in & import_.registers().full) | (q_.parked_out & ~export_.registers().busy);
  next_.access = q_.hold | q_.result | q_.done | q_.fault;
  next_.import = import_.moves();
  next_.exports = export_.moves();
}

inline void RayAlu::clock_engines(ImportKind import_start, const UnitInputs& inputs, RayMemory& memory) {
  if (next_.import || inputs.import_beat_valid || import_start != ImportKind::None) {
    RayImport::Inputs in;
    in.start_kind = import_start;
    in.start_threads = inputs.launch.threads;
    in.request_ready = inputs.import_request_ready;
    in.beat_valid = inputs.import_beat_valid;
    if (in.beat_valid) in.input_set = roles_[import_.receive_warp()].input;
    import_.clock(in);
  }
  if (next_.exports) {
    const bool granted = memory.grant(export_.read(), export_.read_set());
    export_.clock(granted, roles_[export_.next_warp()].output, inputs.export_ready, inputs.frame_ready);
  }
}

inline void RayAlu::swap(uint32_t warp) {
  const uint32_t bit = 1u << warp;
  Roles& roles = roles_[warp];
  if ((q_.parked_in & bit) != 0) {
    q_.parked_in &= ~bit;
    std::swap(roles.input, roles.current);
    import_.take(warp);
  } else {
    q_.parked_out &= ~bit;
    std::swap(roles.output, roles.current);
    if (tasks_[warp].mask != 0) export_.push(warp);
  }
}

// A task that swaps waits until it can.
inline void RayAlu::park(uint32_t warp) {
  const Task& task = tasks_[warp];
  if (task.access()) return;
  if (task.opcode == Opcode::Rin) {
    q_.parked_in |= 1u << warp;
    return;
  }
  q_.parked_out |= 1u << warp;
  q_.exports = static_cast<uint16_t>(q_.exports + popcount(task.mask));
  export_.park(warp, task.opcode == Opcode::Rfb, task.mask);
}

}  // namespace raypool
