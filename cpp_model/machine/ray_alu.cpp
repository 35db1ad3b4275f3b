#include "machine/ray_alu.hpp"

#include <algorithm>
#include <utility>

#include "bits.hpp"

namespace raypool {

RayAlu::RayAlu(const Configuration& configuration, const RaySlices& slices)
    : last_step_(configuration.lanes > 4 ? static_cast<uint32_t>(configuration.lanes) / 4 - 1 : 0),
      tasks_(static_cast<size_t>(configuration.warps)),
      roles_(static_cast<size_t>(configuration.warps)),
      import_(configuration),
      export_(slices) {}

void RayAlu::reset() {
  std::fill(roles_.begin(), roles_.end(), Roles{});
  q_ = Registers{};
  import_.reset();
  export_.reset();
  active_ = false;
}

int RayAlu::clock(int arriving, ImportKind import_start, const UnitInputs& inputs) {
  const uint32_t ready_swaps = can();
  RayMemory memory;
  memory.grant(import_.registers().write, import_.registers().write_set);
  const bool result_end =
      (q_.hold | q_.result | q_.done | q_.fault | (arriving >= 0)) && clock_access(arriving, memory);
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
  active_ = q_.hold | q_.result | q_.fault | q_.done | (can() != 0) | import_.moves() | export_.moves();
  return swapped;
}

// An access makes a step a cycle, the first one as it arrives; true in the cycle after its last.
bool RayAlu::clock_access(int arriving, RayMemory& memory) {
  const bool result_end = q_.result && q_.result_last;
  q_.done = result_end;
  q_.trace = result_end && q_.hold_write;
  q_.done_warp = q_.hold_warp;

  if (arriving >= 0) {
    const Task& task = tasks_[static_cast<size_t>(arriving)];
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

void RayAlu::clock_engines(ImportKind import_start, const UnitInputs& inputs, RayMemory& memory) {
  if (import_.moves() || inputs.import_beat_valid || import_start != ImportKind::None) {
    RayImport::Inputs in;
    in.start_kind = import_start;
    in.start_threads = inputs.launch.threads;
    in.request_ready = inputs.import_request_ready;
    in.beat_valid = inputs.import_beat_valid;
    if (in.beat_valid) in.input_set = roles_[import_.receive_warp()].input;
    import_.clock(in);
  }
  if (export_.moves()) {
    const bool granted = memory.grant(export_.read(), export_.read_set());
    export_.clock(granted, roles_[export_.next_warp()].output, inputs.export_ready, inputs.frame_ready);
  }
}

void RayAlu::swap(uint32_t warp) {
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
void RayAlu::park(uint32_t warp) {
  const Task& task = tasks_[warp];
  if (task.access()) return;
  (task.opcode == Opcode::Rin ? q_.parked_in : q_.parked_out) |= 1u << warp;
  if (task.opcode != Opcode::Rin) export_.park(warp, task.opcode == Opcode::Rfb, task.mask);
}

}  // namespace raypool
