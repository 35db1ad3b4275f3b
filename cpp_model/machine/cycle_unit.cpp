#include "machine/cycle_unit.hpp"

#include <algorithm>
#include <cstring>

#include "machine/bits.hpp"

namespace raypool {
namespace {

constexpr uint8_t kInstructionId = 16;  // of a read of the instruction side
constexpr uint8_t kLastBeat = 3;        // of a line

constexpr size_t index(AluType type) { return static_cast<size_t>(type); }

// Operations of the ray ALU stand in the order of these kinds.
RayAlu::Task::Kind ray_kind(const DecodedInstruction& instruction, bool faults) {
  return faults ? RayAlu::Task::Kind::Illegal : static_cast<RayAlu::Task::Kind>(instruction.code & 31);
}

}  // namespace

CycleUnit::CycleUnit(const Configuration& configuration, const Memory& memory)
    : lanes_(configuration.cores),
      host_memory_(&memory),
      core_(configuration, memory_),
      mem_(configuration),
      ray_(configuration, core_.slices()),
      instruction_cache_(configuration),
      issues_(static_cast<size_t>(configuration.warps)),
      timings_(static_cast<size_t>(configuration.warps)) {
  for (size_t type = 0; type < kAluTypes; ++type) {
    const AluConfiguration& alu = configuration.alus[type];
    slots_[type].count = static_cast<uint32_t>(alu.count);
    slots_[type].latency = static_cast<uint32_t>(alu.latency);
    slots_[type].depth = static_cast<uint32_t>(alu.depth);
  }
}

void CycleUnit::reset(uint32_t program_length, uint32_t memory_limit) {
  program_length_ = program_length;
  core_.reset(program_length, memory_limit);
  mem_.reset();
  ray_.reset();
  instruction_cache_.reset();
  memory_stale_ = true;
  ring_.fill(Planned{});
  active_ = fetching_ = missed_ = full_ = control_ = want_types_ = 0;
  behind_ = idle_ = ~0u;
  first_ = 0;
  wants_.fill(0);
  mem_wants_ = ray_wants_ = 0;
  fetch_cycle_ = now_;
  for (Slots& slots : slots_) {
    slots.free_at.fill(0);
    slots.unready = 0;
  }
  mem_task_ = ray_task_ = -1;
  attention_ = faulty_ = false;
  request_valid_ = waiting_ = running_ = false;
  package_beats_ = 0;
  fault_ = Fault{};
  raised_.clear();
  planned_faults_.clear();
  busy_cycles_ = instructions_ = thread_instructions_ = hits_ = misses_ = 0;
  waited_.fill(0);
  issued_.fill(0);
  outputs_ = UnitOutputs{};
  signals_ = outputs_.signals();
  trace_ = UnitTrace{};
  std::fill(timings_.begin(), timings_.end(), Timing{});
  present(signals());
}

void CycleUnit::set_argument(int number, uint32_t value) {
  core_.set_argument(number, value);
  mem_.invalidate();
  instruction_cache_.invalidate();
  memory_stale_ = true;
  clock({});  // it takes a cycle
}

void CycleUnit::clock(const UnitInputs& inputs) {
  step(inputs);
  present(signals());
  if (tracing_) record();
}

// ---- The data routine

// What is issued in a cycle wants its ALU two cycles later, together with those that were not granted before. All of them are
// known now, and so are the instances that will be free then, so the pipelined types are dispatched two cycles ahead: mostly that
// is all there is to do for an instruction until it retires. Each type's free instances take the lowest warps.
void CycleUnit::dispatch_ahead() {
  const uint64_t cycle = now_ + kAhead;
  for (uint32_t types = want_types_; types != 0; types &= types - 1) {
    const uint32_t type = lowest(types);
    Slots& slots = slots_[type];
    uint32_t wants = wants_[type];
    for (uint32_t slot = 0; slot < slots.count && wants != 0; ++slot) {
      if (slots.free_at[slot] > cycle) continue;
      planned(cycle + 1 + slots.depth).retired |= wants & (0u - wants);
      wants &= wants - 1;
      slots.free_at[slot] = cycle + slots.latency;
      slots.unready += slots.latency - 1;
      ++issued_[type];
    }
    wants_[type] = wants;
    if (wants == 0) want_types_ &= ~(1u << type);
    waited_[type] += popcount(wants);
  }
}

// Mem and Ray say themselves, in the very cycle, whether they take a task.
void CycleUnit::dispatch(uint32_t& wants, bool ready, int& task, AluType type) {
  if (ready) {
    task = static_cast<int>(lowest(wants));
    wants &= wants - 1;
    ++issued_[index(type)];
  }
  waited_[index(type)] += popcount(wants);
}

// The instruction in the buffer becomes the warp's current one and is executed, unless it has to wait for a slice to arrive or
// leave.
void CycleUnit::issue_warp(uint32_t warp) {
  const uint32_t bit = 1u << warp;
  const DecodedInstruction* instruction = core_.instruction_at(fetch_pc_[warp]);
  if (!instruction->legal()) return raise({FaultCode::IllegalInstruction, warp, fetch_pc_[warp]});
  full_ &= ~bit;
  idle_ &= ~bit;
  pc_[warp] = fetch_pc_[warp];
  const uint8_t type = static_cast<uint8_t>(instruction->code >> 5);
  if (type == index(AluType::Mem)) {
    planned(now_ + kAhead).mem_wants |= bit;
  } else if (type == index(AluType::Ray)) {
    planned(now_ + kAhead).ray_wants |= bit;
  } else {
    wants_[type] |= bit;
    want_types_ |= 1u << type;
  }
  if (tracing_) record_issue(warp, *instruction);

  uint32_t mask;
  bool faults = false;
  const bool swaps = type == index(AluType::Ray) && (instruction->code & 31) < 3;
  if (swaps) {
    mask = core_.thread_mask(warp, *instruction);
    ray_.task(warp) = {ray_kind(*instruction, false), mask};
  } else {
    const Step& step = core_.step(warp);
    mask = step.mask;
    faults = step.status == Step::Status::Fault;
    if (type == index(AluType::Mem)) {
      begin_memory(warp, step);
    } else if (type == index(AluType::Ray)) {
      ray_.task(warp) = {ray_kind(*instruction, faults), mask};
    } else if (instruction->info->control) {
      control_ |= bit;
      stack_fault_[warp] = faults ? step.fault.code : FaultCode::None;
    }
    if (tracing_) record_result(warp, step);
    if (faults) {
      core_.forget_fault();
      faulty_ = attention_ = true;
    }
  }
  ++instructions_;
  thread_instructions_ += popcount(mask);
  // The core's PC stays at an instruction that has not been executed; the RTL's instruction routine goes on behind it.
  if (!instruction->info->control) plan_fetch(warp, now_ + 1, swaps || faults);
}

void CycleUnit::begin_memory(uint32_t warp, const Step& step) {
  MemAlu::Task& task = mem_.task(warp);
  task.store = (step.instruction->code & 31) == 1;
  task.fault = step.status == Step::Status::Fault ? step.fault.code : FaultCode::None;
  task.count = 0;
  if (step.store_count != 0) {
    for (uint32_t i = 0; i < step.store_count; ++i) mem_.add_store(task, step.stores[i].address, step.stores[i].value);
  } else {
    for (uint32_t lanes = step.mask; lanes != 0; lanes &= lanes - 1) mem_.add_load(task, step.addresses[lowest(lanes)]);
  }
}

// Control instructions among the warps that retire: only now does the instruction routine go on.
void CycleUnit::retire_control(uint32_t warps) {
  control_ &= ~warps;
  for (; warps != 0; warps &= warps - 1) {
    const uint32_t warp = lowest(warps);
    if (stack_fault_[warp] != FaultCode::None) {
      raise({stack_fault_[warp], warp, pc_[warp]});
    } else if (!core_.warp_running(warp)) {
      active_ &= ~(1u << warp);
      attention_ = true;
    } else {
      plan_fetch(warp, now_ + 1, false);
    }
  }
}

// ---- The instruction routine

// The fetch arbiter's grants of the cycles up to `until`, and what the cache says to them.
void CycleUnit::fetch(uint64_t until) {
  for (; fetch_cycle_ <= until; ++fetch_cycle_) {
    uint32_t& joining = planned(fetch_cycle_).fetches;
    fetching_ |= joining;
    joining = 0;
    if (fetching_ == 0) continue;
    uint32_t bit = fetching_ & first_;
    if (bit == 0) {
      const uint32_t behind = fetching_ & behind_;
      const uint32_t candidates = behind != 0 ? behind : fetching_;
      bit = candidates & (0u - candidates);
      behind_ = ~(bit | (bit - 1));
    }
    first_ = 0;
    lookup_warp_ = lowest(bit);
    fetching_ &= ~bit;
    if (instruction_cache_.lookup(fetch_pc_[lookup_warp_])) {
      planned(fetch_cycle_ + 2).full |= bit;
      ++hits_;
    } else {
      miss_cycle_ = fetch_cycle_ + 1;
      attention_ = true;
      until = std::min(until, fetch_cycle_);
    }
  }
}

// The PC stack is stepped from `cycle` on: a cycle for each entry that is popped, and one for the PC that is taken.
void CycleUnit::plan_fetch(uint32_t warp, uint64_t cycle, bool past_current) {
  const FunctionalCore::Fetch fetch = core_.next_fetch(warp, past_current);
  fetch_pc_[warp] = fetch.pc;
  if (tracing_) {
    timings_[warp].fetch_pc = fetch.pc;
    timings_[warp].fetch_cycle = cycle + fetch.pops + 1;
  }
  if (fetch.pc >= program_length_) {
    planned_faults_.push_back({cycle + fetch.pops, {FaultCode::PcOutsideProgram, warp, fetch.pc}});
    faulty_ = attention_ = true;
  } else {
    planned(cycle + fetch.pops + 1).fetches |= 1u << warp;
  }
}

// ---- Launch, imports, faults

void CycleUnit::start_kernel() {
  waiting_ = false;
  if (memory_stale_) {
    memory_ = *host_memory_;
    memory_stale_ = false;
  }
  core_.launch(waiting_launch_);
  const uint32_t lanes = static_cast<uint32_t>(lanes_);
  for (uint32_t warp = 0; warp * lanes < waiting_launch_.threads; ++warp) {
    active_ |= 1u << warp;
    plan_fetch(warp, now_ + 1, false);
  }
}

void CycleUnit::take_package_beat(const Beat& beat) {
  package_[package_beats_] = beat;
  if (++package_beats_ < kIntersectionBeats) return;
  package_beats_ = 0;
  Intersection package;
  std::memcpy(package.data(), package_.data(), sizeof(package));
  core_.import_package(package);
}

void CycleUnit::raise(const Fault& fault) {
  if (fault_.code == FaultCode::None) raised_.push_back(fault);
  faulty_ = attention_ = true;
}

// The first fault stays; of several in one cycle an ALU's wins, memory's before rays', then the lowest warp's.
void CycleUnit::settle_faults(FaultCode mem_fault, uint32_t mem_warp, bool ray_fault, uint32_t ray_warp) {
  if (fault_.code != FaultCode::None) return;
  for (const PlannedFault& planned_fault : planned_faults_) {
    if (planned_fault.cycle == now_) raise(planned_fault.fault);
  }
  std::sort(raised_.begin(), raised_.end(), [](const Fault& a, const Fault& b) { return a.warp < b.warp; });
  if (ray_fault) raised_.insert(raised_.begin(), {FaultCode::RayWordOutside, ray_warp, pc_[ray_warp]});
  if (mem_fault != FaultCode::None) raised_.insert(raised_.begin(), {mem_fault, mem_warp, pc_[mem_warp]});
  if (raised_.empty()) return;
  fault_ = raised_.front();
  halt();
}

// From the next cycle on nothing is fetched or dispatched, but some cycles have been worked out already.
void CycleUnit::halt() {
  want_types_ = 0;
  for (uint64_t cycle = now_ + 1; cycle < now_ + kRing; ++cycle) {
    uint32_t& retired = planned(cycle).retired;
    for (uint32_t warps = retired; warps != 0; warps &= warps - 1) {
      const uint32_t warp = lowest(warps);
      const uint64_t depth = slots_[static_cast<size_t>(core_.instruction_at(pc_[warp])->code >> 5)].depth;
      if (cycle - depth > now_ + 1) retired &= ~(1u << warp);
    }
  }
  if (instruction_cache_.missed() && miss_cycle_ > now_ + 1) instruction_cache_.forget_miss();
}

// Instances that are taken while no kernel runs are not counted as such.
void CycleUnit::run_changes(bool running) {
  running_ = running;
  for (Slots& slots : slots_) {
    for (uint32_t slot = 0; slot < slots.count; ++slot) {
      const uint64_t rest = slots.free_at[slot] > now_ + 1 ? slots.free_at[slot] - (now_ + 1) : 0;
      if (running)
        slots.unready += rest;
      else
        slots.unready -= rest;
    }
  }
}

// ---- One cycle

// Most cycles have nothing to do with memory, launches or faults.
void CycleUnit::step(const UnitInputs& inputs) {
  if (attention_ || inputs.memory_response_valid || inputs.launch_valid) return step_all(inputs);
  Planned& slot = planned(now_);
  full_ |= slot.full;
  mem_wants_ |= slot.mem_wants;
  ray_wants_ |= slot.ray_wants;
  const uint32_t retired = slot.retired | ray_.done();
  slot.retired = slot.full = slot.mem_wants = slot.ray_wants = 0;
  busy_cycles_ += running_;
  advance_warps(retired);
  // In most cycles no warp wants the instruction cache.
  if (fetch_cycle_ == now_ + kAhead && (fetching_ | planned(fetch_cycle_).fetches) == 0)
    ++fetch_cycle_;
  else
    fetch(now_ + kAhead);
  if (want_types_ != 0) dispatch_ahead();
  const bool ray_ready = ray_.ready(ray_task_);
  advance_rays(inputs, ImportKind::None);
  if (ray_wants_ != 0) dispatch(ray_wants_, ray_ready, ray_task_, AluType::Ray);
  if (mem_wants_ != 0) {
    dispatch(mem_wants_, true, mem_task_, AluType::Mem);
    attention_ = true;
  }
  if (faulty_) settle_faults(FaultCode::None, 0, false, 0);
  ++now_;
}

void CycleUnit::step_all(const UnitInputs& inputs) {
  // Everything is worked out from the registers of this cycle; where a block changes its own, what others need is taken first.
  Planned& slot = planned(now_);
  full_ |= slot.full;
  mem_wants_ |= slot.mem_wants;
  ray_wants_ |= slot.ray_wants;
  const uint32_t retired = slot.retired | mem_.done() | ray_.done();
  slot.retired = slot.full = slot.mem_wants = slot.ray_wants = 0;
  const bool halted = fault_.code != FaultCode::None;
  const bool mem_ready = mem_.ready();
  const bool ray_ready = ray_.ready(ray_task_);
  const FaultCode mem_fault = mem_.fault();
  const uint32_t mem_fault_warp = mem_.fault_warp();
  const bool ray_fault = ray_.fault();
  const uint32_t ray_fault_warp = ray_.fault_warp();
  const bool accepts = inputs.launch_valid && !waiting_ && !ray_.import_active();
  busy_cycles_ += running_;

  // Memory arbiter.
  const bool arbiter_free = !request_valid_ || inputs.memory_request_ready;
  const bool instruction_request = instruction_cache_.request_valid();
  const bool data_ready = arbiter_free && !instruction_request;
  if (arbiter_free) {
    request_valid_ = instruction_request || mem_.request_valid();
    if (instruction_request) {
      request_ = MemoryRequest{};
      request_.address = instruction_cache_.request_address();
      request_.id = kInstructionId;
    } else if (request_valid_) {
      request_ = mem_.request();
    }
  }
  const bool of_instruction = inputs.memory_response_valid && inputs.memory_response.id == kInstructionId;
  const bool data_response = inputs.memory_response_valid && !of_instruction;

  // Begin and end of a kernel.
  if (waiting_ && !running_) {
    start_kernel();
    run_changes(true);
  } else if (running_ && active_ == 0) {
    run_changes(false);
  }

  advance_warps(retired);

  // Instruction cache and fetch arbiter. What has missed asks again when a line has come. Without a line on its way the cache's
  // answers are known ahead.
  const bool missed = instruction_cache_.missed() && miss_cycle_ == now_;
  if (missed || instruction_request || of_instruction || instruction_cache_.active()) {
    uint32_t fetches_next = 0, first_next = 0;
    if (missed) {
      missed_ |= 1u << lookup_warp_;
      ++misses_;
    }
    if (instruction_cache_.refill_done()) {
      fetches_next = missed_;
      missed_ = 0;
      first_next = 1u << instruction_cache_.fetch_warp();
    }
    instruction_cache_.clock(missed, lookup_warp_, arbiter_free, of_instruction && inputs.memory_response.beat == kLastBeat);
    if (!halted) fetch(now_);
    instruction_cache_.end_cycle();
    fetching_ |= fetches_next;
    first_ = first_next;
  }
  if (!halted) fetch(instruction_cache_.busy() ? now_ : now_ + kAhead);
  if (want_types_ != 0) dispatch_ahead();

  if (mem_task_ >= 0 || data_response || mem_.active()) {
    mem_.clock({mem_task_, data_response, inputs.memory_response.id, inputs.memory_response.beat, data_ready});
    mem_task_ = -1;
  }
  advance_rays(inputs, accepts ? inputs.launch.import : ImportKind::None);
  if (mem_wants_ != 0 && !halted) dispatch(mem_wants_, mem_ready, mem_task_, AluType::Mem);
  if (ray_wants_ != 0 && !halted) dispatch(ray_wants_, ray_ready, ray_task_, AluType::Ray);

  if (accepts) {
    waiting_ = true;
    waiting_launch_ = inputs.launch;
    if (inputs.launch.import != ImportKind::None) core_.expect_import(inputs.launch.threads);
  }
  if (faulty_) settle_faults(mem_fault, mem_fault_warp, ray_fault, ray_fault_warp);
  attention_ = faulty_ || request_valid_ || instruction_cache_.busy() || mem_.active() || mem_task_ >= 0 ||
               (waiting_ && !running_) || (running_ && active_ == 0);
  ++now_;
}

// Write-back and the next instructions. Who retires in this cycle may issue in it.
void CycleUnit::advance_warps(uint32_t retired) {
  idle_ |= retired;
  if ((retired & control_) != 0) retire_control(retired & control_);
  uint32_t warps = full_ & idle_;
  if (warps == 0 || fault_.code != FaultCode::None) return;
  for (; warps != 0; warps &= warps - 1) issue_warp(lowest(warps));
}

void CycleUnit::advance_rays(const UnitInputs& inputs, ImportKind import) {
  if (inputs.import_beat_valid) take_package_beat(inputs.import_beat);
  if (ray_task_ < 0 && !inputs.import_beat_valid && import == ImportKind::None && !ray_.active()) return;
  const int swapped = ray_.clock(ray_task_, import, inputs);
  ray_task_ = -1;
  if (swapped >= 0) core_.step(static_cast<uint32_t>(swapped));
}

bool CycleUnit::quiet() const {
  return (full_ & idle_) == 0 && (want_types_ | mem_wants_ | ray_wants_ | fetching_) == 0 && mem_task_ < 0 && ray_task_ < 0 &&
         !request_valid_ && !instruction_cache_.request_valid() && !instruction_cache_.active() &&
         !(instruction_cache_.missed() && miss_cycle_ >= now_) && !mem_.active() && !ray_.active() && !(waiting_ && !running_) &&
         !(running_ && active_ == 0) && planned_faults_.empty();
}

uint64_t CycleUnit::run(const UnitInputs& inputs, uint64_t cycles) {
  const uint32_t before = signals_;
  const bool transfers = (before & inputs.ready_signals()) != 0;
  step(inputs);
  uint32_t now = signals();
  uint64_t done = 1;
  if (done < cycles && !transfers && now == before) {
    UnitInputs rest;
    rest.memory_request_ready = inputs.memory_request_ready;
    rest.import_request_ready = inputs.import_request_ready;
    rest.export_ready = inputs.export_ready;
    rest.frame_ready = inputs.frame_ready;
    do {
      if (quiet()) {
        // Nothing happens before the next planned event.
        uint64_t skip = 0;
        while (skip < kRing && done + skip < cycles && !planned(now_ + skip).any()) ++skip;
        if (skip == kRing) skip = cycles - done;
        now_ += skip;
        fetch_cycle_ = std::max(fetch_cycle_, now_);
        busy_cycles_ += running_ ? skip : 0;
        done += skip;
        if (done == cycles) break;
      }
      step(rest);
      now = signals();
      ++done;
    } while (done < cycles && now == before);
  }
  present(now);
  if (tracing_) record();
  return done;
}

// ---- What is seen from outside

// As UnitOutputs::signals().
uint32_t CycleUnit::signals() const {
  const bool works = running_ | waiting_ | request_valid_ | ray_.moves_rays();
  const bool idle = !works && mem_.idle();
  return ray_.signals() | !(waiting_ | ray_.import_active()) * signal::kLaunchReady | idle * (signal::kIdle | signal::kUnitIdle) |
         request_valid_ * signal::kMemoryRequest | (fault_.code != FaultCode::None) * signal::kFault |
         (running_ && active_ == 0) * signal::kKernelDone | running_ * signal::kBusy;
}

void CycleUnit::present(uint32_t now) {
  UnitOutputs& out = outputs_;
  if (now != signals_) {
    const auto is_set = [now](uint32_t flag) { return (now & flag) != 0; };
    signals_ = now;
    out.launch_ready = is_set(signal::kLaunchReady);
    out.idle = is_set(signal::kIdle);
    out.memory_request_valid = is_set(signal::kMemoryRequest);
    out.import_request_valid = is_set(signal::kImportRequest);
    out.export_valid = is_set(signal::kExport);
    out.frame_valid = is_set(signal::kFrame);
    out.kernel_done = is_set(signal::kKernelDone);
    out.busy = is_set(signal::kBusy);
    out.unit_idle = is_set(signal::kUnitIdle);
    if (is_set(signal::kFault)) out.fault = fault_;
  }
  if (out.memory_request_valid) out.memory_request = request_;
  out.import_request_kind = ray_.import_kind();
  if (out.export_valid) {
    out.export_data = ray_.beat().data;
    out.export_last = ray_.beat().last;
  } else if (out.frame_valid) {
    const Beat& beat = ray_.beat().data;
    out.frame = {beat[0], {beat[1], beat[2], beat[3]}};
  }
}

uint64_t CycleUnit::counter(int number) {
  switch (number) {
    case counter::kBusyCycles:
      return busy_cycles_;
    case counter::kInstructions:
      return instructions_;
    case counter::kThreadInstructions:
      return thread_instructions_;
    case counter::kInstructionCacheHits:
      return hits_;
    case counter::kInstructionCacheMisses:
      return misses_;
    case counter::kDataCacheHits:
      return mem_.hits();
    case counter::kDataCacheMisses:
      return mem_.misses();
    case counter::kDataCacheStores:
      return mem_.stores();
    default:
      break;
  }
  const size_t type = static_cast<size_t>(number & 7);
  if (type >= kAluTypes) return 0;
  switch (number & ~7) {
    case counter::kUnused: {
      const Slots& slots = slots_[type];
      uint64_t unready = slots.unready;
      if (type == index(AluType::Mem)) unready = mem_.unready();
      if (type == index(AluType::Ray)) unready = ray_.unready();
      for (uint32_t slot = 0; running_ && slot < slots.count; ++slot) {
        if (slots.free_at[slot] > now_) unready -= slots.free_at[slot] - now_;
      }
      return busy_cycles_ * slots.count - unready - issued_[type];
    }
    case counter::kWaiting:
      return waited_[type];
    case counter::kIssued:
      return issued_[type];
    default:
      return 0;
  }
}

}  // namespace raypool
