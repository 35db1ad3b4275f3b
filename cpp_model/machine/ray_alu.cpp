#include "machine/ray_alu.hpp"

#include <algorithm>

#include "machine/bits.hpp"

namespace raypool {
namespace {

constexpr uint32_t kRing = 32;  // warps at most, of which each is in the export's order once

}  // namespace

RayAlu::RayAlu(const Configuration& configuration)
    : lane_bits_(lowest(static_cast<uint32_t>(configuration.cores))),
      last_lane_(static_cast<uint32_t>(configuration.cores) - 1),
      last_step_(configuration.cores > 4 ? static_cast<uint32_t>(configuration.cores) / 4 - 1 : 0),
      tasks_(static_cast<size_t>(configuration.warps)),
      roles_(static_cast<size_t>(configuration.warps)),
      order_(kRing),
      reads_(static_cast<size_t>(configuration.warps)) {
  // A warp's slice is busy until it has been read, so at most one and a few beats more are there.
  uint32_t beats = 4;
  while (beats < static_cast<uint32_t>(configuration.contents() * kRayBeats + 4)) beats *= 2;
  beats_.resize(beats);
  beats_mask_ = beats - 1;
}

void RayAlu::reset() {
  std::fill(roles_.begin(), roles_.end(), Roles{});
  state_ = 0;
  step_ = 0;
  done_ = 0;
  wrote_ = false;
  parked_input_ = parked_output_ = 0;
  outstanding_ = 0;
  full_ = 0;
  first_ = end_ = busy_ = 0;
  waiting_ = 0;
  beats_first_ = beats_end_ = 0;
  unready_ = 0;
}

int RayAlu::clock(int arriving, ImportKind import_start, const UnitInputs& inputs) {
  // The engines see the roles of this cycle, so a swap comes after them.
  // Conditions that come out either way from cycle to cycle are joined without branches.
  bool read_granted = is(kSlice) & (waiting_ != 3) & !writes(slice_set_);
  int swap = -1;
  if ((arriving >= 0) | (((state_ & (kHold | kResult | kFault)) | done_ | can()) != 0))
    swap = clock_kernel(arriving, read_granted);
  if (is(kWrite | kImportMoves) | inputs.import_beat_valid | (import_start != ImportKind::None))
    clock_import(import_start, inputs);
  if (is(kExports)) clock_export(inputs, read_granted);
  if (arriving >= 0) {
    const Task::Kind kind = tasks_[static_cast<size_t>(arriving)].kind;
    parked_input_ |= uint32_t{kind == Task::Kind::Input} << arriving;
    parked_output_ |= uint32_t{kind == Task::Kind::Output} << arriving;
  }
  if (swap >= 0) execute_swap(static_cast<uint32_t>(swap));
  return swap;
}

// Tasks: accesses, one step a cycle, and the choice of a swap. An access may take the port of the export's set.
int RayAlu::clock_kernel(int arriving_warp, bool& read_granted) {
  unready_ += !ready(arriving_warp);
  const Task* task = arriving_warp >= 0 ? &tasks_[static_cast<size_t>(arriving_warp)] : nullptr;
  const uint32_t arriving = static_cast<uint32_t>(std::max(arriving_warp, 0));
  const bool arrives_access = task != nullptr && (task->kind == Task::Kind::Read || task->kind == Task::Kind::Write);
  if (arrives_access) {
    hold_warp_ = arriving;
    hold_set_ = roles_[arriving].current;
    hold_writes_ = task->kind == Task::Kind::Write;
  }
  const bool access = is(kHold) | arrives_access;
  const bool access_granted = access & !writes(hold_set_);
  const bool access_last = step_ == last_step_;
  const bool result_end = is(kResult) & is(kResultLast);
  read_granted &= !(access & (hold_set_ == slice_set_));
  const uint32_t ready_swaps = can();
  const int swap = ready_swaps != 0 && !result_end ? static_cast<int>(lowest(ready_swaps)) : -1;

  // Done: an access first. The result stage knows its own task, as the next one may be held by now.
  done_ = result_end ? 1u << result_warp_ : swap >= 0 ? 1u << swap : 0;
  wrote_ = result_end & result_writes_;
  fault_warp_ = arriving;
  state_ &= ~(kHold | kResult | kResultLast | kFault);
  if (task != nullptr && task->kind == Task::Kind::Illegal) state_ |= kFault;
  if (access_granted) {
    state_ |= access_last ? kResult | kResultLast : kResult | kHold;
    result_warp_ = hold_warp_;
    result_writes_ = hold_writes_;
    step_ = access_last ? 0 : step_ + 1;
  } else if (access) {
    state_ |= kHold;
  }
  return swap;
}

void RayAlu::execute_swap(uint32_t warp) {
  const uint32_t bit = 1u << warp;
  Roles& roles = roles_[warp];
  if ((parked_input_ & bit) != 0) {
    parked_input_ &= ~bit;
    full_ &= ~bit;
    std::swap(roles.input, roles.current);
    settle_import();
    return;
  }
  parked_output_ &= ~bit;
  std::swap(roles.output, roles.current);
  if (tasks_[warp].empty) return;
  order_[end_++ % kRing] = warp;
  busy_ |= bit;
  state_ |= kOrder | kExporting;
  reads_[warp] = 0;
  added_ = warp;
}

void RayAlu::clock_import(ImportKind start, const UnitInputs& inputs) {
  const uint32_t warp = received_ >> lane_bits_;
  set(kWrite, inputs.import_beat_valid);
  if (inputs.import_beat_valid) write_set_ = roles_[warp].input;
  if (is(kImporting)) {
    const bool received = inputs.import_beat_valid && import_beat_ == kIntersectionBeats - 1;
    const bool taken = is(signal::kImportRequest) & inputs.import_request_ready;
    requested_ += taken;
    outstanding_ += static_cast<uint32_t>(taken) - static_cast<uint32_t>(received);
    set(signal::kImportRequest, can_request());
    if (inputs.import_beat_valid) import_beat_ = received ? 0 : import_beat_ + 1;
    if (received) {
      const bool launch_end = received_ + 1 == threads_;
      if (launch_end || (received_ & last_lane_) == last_lane_) full_ |= 1u << warp;
      if (launch_end) state_ &= ~kImporting;
      ++received_;
    }
  }
  if (start != ImportKind::None) {
    state_ |= kImporting;
    import_kind_ = start;
    threads_ = inputs.launch.threads;
    requested_ = received_ = import_beat_ = 0;
  }
  settle_import();
}

void RayAlu::clock_export(const UnitInputs& inputs, bool granted) {
  // Beats leave, and one that was read in the cycle before joins those that wait.
  const uint32_t leaves = (is(signal::kFrame) & inputs.frame_ready) | (is(signal::kExport) & inputs.export_ready);
  beats_first_ += leaves;
  waiting_ += static_cast<uint32_t>(granted) - leaves;

  bool slice_end = false;
  if (granted) {
    slice_end = --reads_[slice_warp_] == 0;
    if (slice_end) busy_ &= ~(1u << slice_warp_);
  }
  const bool load = is(kNext) & (!is(kSlice) | slice_end);
  const bool take_first = is(kOrder) & (!is(kNext) | load);
  uint32_t state = state_ & ~(kExports | signal::kExport | signal::kFrame | kExporting);
  if (load) {
    slice_warp_ = next_warp_;
    slice_set_ = roles_[next_warp_].output;
  }
  if (take_first) next_warp_ = order_[first_++ % kRing];
  state |= load | (is(kSlice) & !slice_end) ? kSlice : 0;
  state |= take_first | (is(kNext) & !load) ? kNext : 0;
  state |= first_ != end_ ? kOrder : 0;
  state |= waiting_ != 0 ? kWaiting : 0;
  state |= (busy_ | waiting_) != 0 ? kExporting : 0;
  state |= waiting_ == static_cast<uint32_t>(granted) ? 0 : beat().frame ? signal::kFrame : signal::kExport;
  state_ = state;
}

void RayAlu::add_ray(const Ray& ray) {
  for (size_t beat = 0; beat < kRayBeats; ++beat) {
    OutBeat out;
    out.last = beat == kRayBeats - 1;
    std::copy_n(&ray[beat * kBeatWords], kBeatWords, out.data.begin());
    push_beat(out);
  }
  reads_[added_] += kRayBeats;
}

void RayAlu::add_contribution(const FrameContribution& contribution) {
  push_beat({true, true, {contribution.pixel, contribution.rgb[0], contribution.rgb[1], contribution.rgb[2]}});
  ++reads_[added_];
}

}  // namespace raypool
