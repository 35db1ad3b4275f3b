#include "machine/compute/cycle_unit.hpp"

#include <algorithm>
#include <utility>

#include "bits.hpp"

namespace raypool {
namespace {

constexpr uint8_t kLastBeat = 3;  // of a line

constexpr size_t index(AluType type) { return static_cast<size_t>(type); }

}  // namespace

CycleUnit::CycleUnit(const Configuration& configuration, std::shared_ptr<ModelMemory> memory, uint32_t unit)
    : warps_(static_cast<uint32_t>(configuration.warps)),
      lanes_(static_cast<uint32_t>(configuration.lanes)),
      counter_bits_(configuration.counter_bits),
      memory_(std::move(memory)),
      core_(configuration, memory_->words(), unit),
      launcher_(configuration),
      instruction_cache_(configuration),
      dispatcher_(configuration),
      mem_(configuration),
      ray_(configuration, core_.slices()),
      issues_(static_cast<size_t>(configuration.warps), std::deque<Issue>(1)),
      timings_(static_cast<size_t>(configuration.warps)) {}

void CycleUnit::reset(uint32_t program_length, uint32_t memory_limit) {
  program_length_ = program_length;
  core_.reset(program_length, memory_limit);
  memory_->host_may_have_written();
  launcher_.reset();
  buffer_.reset();
  fetch_arbiter_ = {};
  instruction_cache_.reset();
  dispatcher_.reset();
  mem_.reset();
  ray_.reset();
  memory_arbiter_.reset();
  counters_.reset();
  timeline_.reset();
  fetch_cycle_ = ray_counted_ = now_;
  attention_ = faulty_ = false;
  alu_faults_ = {};
  fault_ = Fault{};
  raised_.clear();
  planned_faults_.clear();
  met_subnormal_ = 0;
  met_in_.fill(0);
  outputs_ = UnitOutputs{};
  signals_ = outputs_.signals();
  trace_ = UnitTrace{};
  triples_ = followed_ = 0;
  not_launched_ = ended_ = 0;
  older_ = {};
  std::fill(timings_.begin(), timings_.end(), Timing{});
  std::fill(issues_.begin(), issues_.end(), std::deque<Issue>(1));
  rest_signals_ = signals_but_rays();
  present(signals());
}

void CycleUnit::set_argument(uint32_t number, uint32_t value) {
  core_.set_argument(number, value);
  mem_.invalidate();
  instruction_cache_.invalidate();
  memory_->host_may_have_written();
  clock({});  // it takes a cycle
}

void CycleUnit::clock(const UnitInputs& inputs) {
  step(inputs);
  present(signals());
  if (tracing_) record();
}

// ---- One cycle

// Everything is worked out from the registers of this cycle; where a block changes its own, what others need is taken
// first. In most cycles nothing passes the memory port, and nothing starts, ends or faults.
void CycleUnit::step(const UnitInputs& inputs) {
  const bool attention = attention_ | inputs.memory_response_valid | inputs.launch_valid;
  const bool stopped = halted();
  Timeline::Cycle& due = timeline_.at(now_);
  buffer_.cache_hit(due.full);
  dispatcher_.want(AluType::Mem, due.want_mem);
  dispatcher_.want(AluType::Ray, due.want_ray);
  uint32_t retired = due.done | mem_.done() | ray_.done();
  const uint32_t again = due.again;
  const uint32_t met_subnormal = (due.done | due.part) & met_subnormal_;
  due.done = due.full = due.want_mem = due.want_ray = due.part = due.again = 0;
  const bool mem_ready = mem_.ready();
  const bool ray_ready = ray_.ready(dispatcher_.task(AluType::Ray));
  if (faulty_) alu_faults_ = {mem_.fault(), mem_.fault_warp(), ray_.fault(), ray_.fault_warp()};
  const bool accepts = inputs.launch_valid && launcher_.launch_ready(ray_.import_active());
  counters_.single[counter::kBusyCycles] += launcher_.running();

  older_ = {launcher_.older(), older_[0], older_[1]};

  MemoryPort port;
  if (attention) {
    port = clock_memory_arbiter(inputs);
    clock_launcher();
  }
  // Write-back and the next instructions. A warp that retires in this cycle may issue in it, unless it has a fault.
  const uint32_t faulty = met_subnormal != 0 ? raise_subnormals(met_subnormal) : 0;
  if (retired != 0) {
    if ((retired & triples_) != 0) retired = end_elements(retired);
    counters_.leave(counter::kWarpsInMem, now_ + 1, mem_.done() != 0);
    counters_.leave(counter::kWarpsInRay, now_ + 1, (ray_.done() & retired) != 0);
    if (const uint32_t control = buffer_.retire(retired); control != 0) retire_control(control);
  }
  if (!stopped) {
    for (uint32_t warps = buffer_.ready() & ~faulty; warps != 0; warps &= warps - 1) issue_warp(lowest(warps));
    if (again != 0) {
      dispatcher_.want_again(again);
      if (tracing_) record_next_want(again);
    }
  }
  if (attention) clock_instruction_cache(inputs, port);
  if (!stopped) fetch(attention && instruction_cache_.busy() ? now_ : now_ + kAhead);
  if (dispatcher_.wants_pipelined()) dispatcher_.grant_pipelined(now_ + kAhead, older_[0], timeline_, counters_);
  if (attention) clock_mem(inputs, port);
  clock_ray(inputs, accepts ? inputs.launch.import : ImportKind::None, ray_ready);
  if (dispatcher_.wants(AluType::Ray) != 0 && !stopped) grant_ray(ray_ready);
  if (dispatcher_.wants(AluType::Mem) != 0 && !stopped) {
    if (tracing_ && mem_ready) record_grant(AluType::Mem);
    dispatcher_.grant(AluType::Mem, mem_ready, older_[kAhead], counters_);
    counters_.enter(counter::kWarpsInMem, now_ + 1, mem_ready);
    attention_ = true;
  }
  if (accepts) {
    launcher_.accept(inputs.launch);
    if (inputs.launch.import != ImportKind::None) core_.expect_import(inputs.launch.threads);
  }
  if (faulty_) settle_faults();
  if (attention) attention_ = needs_attention();
  if (attention | attention_) count_states();
  ++now_;
  if (attention | attention_) rest_signals_ = signals_but_rays();
}

bool CycleUnit::needs_attention() const {
  return faulty_ || !memory_arbiter_.idle() || instruction_cache_.busy() || mem_.active() ||
         dispatcher_.task(AluType::Mem) >= 0 || launcher_.acts(buffer_.active());
}

CycleUnit::MemoryPort CycleUnit::clock_memory_arbiter(const UnitInputs& inputs) {
  MemoryPort port;
  port.instruction_request = instruction_cache_.request_valid();
  port.instruction_ready = memory_arbiter_.instruction_request_ready(inputs.memory_request_ready);
  port.data_ready = memory_arbiter_.data_request_ready(inputs.memory_request_ready, port.instruction_request);
  port.instruction_response = inputs.memory_response_valid && MemoryArbiter::of_instruction(inputs.memory_response.id);
  port.data_response = inputs.memory_response_valid && !port.instruction_response;
  memory_arbiter_.clock(inputs.memory_request_ready, port.instruction_request, instruction_cache_.request_address(),
                        mem_.request_valid(), mem_.request());
  return port;
}

void CycleUnit::clock_launcher() {
  const uint32_t active = buffer_.active();
  if (!launcher_.acts(active)) return;
  const bool ran = launcher_.running();
  const uint32_t starts = launcher_.starts(active);
  if (starts != 0) start_warps(starts, launcher_.start_launch());
  launcher_.clock(active);
  if (launcher_.running() != ran) count_pauses(!ran);
}

// Warps without an instruction, from the next cycle on.
void CycleUnit::count_states() {
  const uint32_t active = buffer_.active(), launched = launcher_.launched(active);
  const auto count = [this](int number, uint32_t& before, uint32_t now) {
    counters_.leave(number, now_ + 1, popcount(before & ~now));
    counters_.enter(number, now_ + 1, popcount(now & ~before));
    before = now;
  };
  const uint32_t running = launcher_.running() ? launcher_.all() : 0;
  count(counter::kWarpsNotLaunched, not_launched_, running & ~launched);
  count(counter::kWarpsEnded, ended_, running & launched & ~active);
}

// While a line is on its way, lookups are made in their own cycle: what has missed asks again when the line has come.
void CycleUnit::clock_instruction_cache(const UnitInputs& inputs, const MemoryPort& port) {
  const bool missed = instruction_cache_.missed() && miss_cycle_ == now_;
  if (!missed && !port.instruction_request && !port.instruction_response && !instruction_cache_.active()) return;
  if (missed) {
    buffer_.cache_miss(instruction_cache_.result_warp());
    ++counters_.single[counter::kInstructionCacheMisses];
  }
  const uint32_t again = instruction_cache_.refill_done() ? buffer_.refill_done() : 0;
  instruction_cache_.clock(now_, missed, port.instruction_ready,
                           port.instruction_response && inputs.memory_response.beat == kLastBeat);
  if (!halted()) fetch(now_);
  instruction_cache_.end_cycle();
  buffer_.want_cache(again);
}

void CycleUnit::clock_mem(const UnitInputs& inputs, const MemoryPort& port) {
  const int arriving = dispatcher_.task(AluType::Mem);
  if (arriving < 0 && !port.data_response && !mem_.active()) return;
  counters_.unready[index(AluType::Mem)] += !mem_.ready();
  const MemAlu::Events events = mem_.clock(
      {arriving, port.data_response, inputs.memory_response.id, inputs.memory_response.beat, port.data_ready});
  counters_.single[counter::kDataCacheHits] += events.hit;
  counters_.single[counter::kDataCacheMisses] += events.miss;
  counters_.single[counter::kDataCacheStores] += events.store;
  dispatcher_.arrived(AluType::Mem);
}

[[gnu::always_inline]] inline void CycleUnit::clock_ray(const UnitInputs& inputs, ImportKind import, bool ready) {
  if (inputs.import_beat_valid) core_.import_beat(inputs.import_beat);
  const int arriving = dispatcher_.task(AluType::Ray);
  if (arriving < 0 && !inputs.import_beat_valid && import == ImportKind::None && !ray_.active()) return;
  counters_.unready[index(AluType::Ray)] += !ready;
  count_ray_waits();
  const int swapped = ray_.clock(arriving, import, inputs);
  if (swapped >= 0) core_.step(static_cast<uint32_t>(swapped));
  dispatcher_.arrived(AluType::Ray);
}

// Of the cycles up to this one since the last call, in which the ray ALU had nothing to do but wait.
void CycleUnit::count_ray_waits() {
  const uint64_t cycles = now_ + 1 - ray_counted_;
  ray_counted_ = now_ + 1;
  if (!ray_.parked()) return;
  const uint64_t imports = popcount(ray_.import_wait()) * cycles, exports = popcount(ray_.export_wait()) * cycles;
  counters_.single[counter::kWarpsImporting] += imports;
  counters_.single[counter::kWarpsExporting] += exports;
  counters_.single[counter::kWarpsInRay] -= imports + exports;
}

// Instances that are taken while no kernel runs are not counted as such.
void CycleUnit::count_pauses(bool running) {
  for (size_t type = 0; type < kAluTypes; ++type) {
    const uint64_t rest = dispatcher_.unready(type, now_ + 1);
    counters_.unready[type] += running ? rest : 0 - rest;
  }
}

// ---- Warps

void CycleUnit::start_warps(uint32_t warps, const LaunchCommand& launch) {
  memory_->before_launch();
  core_.prepare();
  for (; warps != 0; warps &= warps - 1) {
    const uint32_t warp = lowest(warps);
    core_.start(warp, launch);
    buffer_.start(warp);
    plan_fetch(warp, now_ + 1, false);
  }
}

// The PC stack is stepped from `cycle` on: a cycle for each entry that is popped, and one for the PC that is taken.
void CycleUnit::plan_fetch(uint32_t warp, uint64_t cycle, bool past_current) {
  const PcStack::Fetch fetch = core_.next_fetch(warp, past_current);
  buffer_.stack_pc(warp, fetch.pc);
  if (tracing_) {
    timings_[warp].fetch_pc = fetch.pc;
    timings_[warp].fetch_cycle = cycle + fetch.pops + 1;
  }
  if (fetch.pc >= program_length_) {
    planned_faults_.push_back({cycle + fetch.pops, {FaultCode::PcOutsideProgram, warp, fetch.pc}});
    faulty_ = attention_ = true;
  } else {
    timeline_.at(cycle + fetch.pops + 1).fetch |= 1u << warp;
  }
}

// The fetch arbiter's grants of the cycles up to `until`, and the cache's answers. Inlined into step() like clock_ray:
// the engine spends its time there.
[[gnu::always_inline]] inline void CycleUnit::fetch(uint64_t until) {
  for (; fetch_cycle_ <= until; ++fetch_cycle_) {
    uint32_t& joining = timeline_.at(fetch_cycle_).fetch;
    const uint32_t requests = buffer_.fetch_request() | joining;
    if (requests == 0) continue;
    buffer_.want_cache(joining);
    joining = 0;
    const uint32_t warp = fetch_arbiter_.grant(requests, instruction_cache_.first(fetch_cycle_));
    buffer_.fetch_grant(1u << warp);
    if (instruction_cache_.lookup(warp, buffer_.fetch_pc(warp))) {
      timeline_.at(fetch_cycle_ + 2).full |= 1u << warp;
      ++counters_.single[counter::kInstructionCacheHits];
    } else {
      miss_cycle_ = fetch_cycle_ + 1;
      attention_ = true;
      until = std::min(until, fetch_cycle_);
    }
  }
}

// The instruction in the buffer becomes the warp's current one and is executed.
void CycleUnit::issue_warp(uint32_t warp) {
  const DecodedInstruction& instruction = *core_.instruction_at(buffer_.fetch_pc(warp));
  if (!instruction.legal()) return raise({FaultCode::IllegalInstruction, warp, buffer_.fetch_pc(warp)});
  buffer_.issue(warp);
  want(warp, instruction);

  // These wait for a slice to arrive or leave; the functional core executes them when they swap.
  const bool swap = instruction.kind == Kind::Swap;
  bool faults = false;
  uint32_t mask;
  if (swap) {
    mask = core_.thread_mask(warp, instruction);
    if (tracing_) record_issue(warp, instruction);
    ++counters_.single[counter::kInstructions];
    counters_.single[counter::kThreadInstructions] += popcount(mask);
  } else {
    const Step& step = execute(warp, instruction);
    mask = step.mask;
    faults = step.status == Step::Status::Fault;
    if (instruction.kind == Kind::Control) {
      buffer_.issue_control(warp);
      stack_fault_[warp] = faults ? step.fault.code : FaultCode::None;
    }
    if (faults) forget_fault();
    uint32_t met = step.subnormal, element = 0;
    // Loads may fault, each at its own time; of the other triples no element can observe when it is executed.
    if (instruction.alu() != AluType::Mem)
      for (const DecodedInstruction* next = instruction.next; next != nullptr; next = next->next)
        met |= uint32_t{execute(warp, *next).subnormal} << ++element;
    if (met != 0) {
      met_in_[warp] = static_cast<uint8_t>(met);
      met_subnormal_ |= 1u << warp;
    }
  }
  if (instruction.alu() == AluType::Ray) ray_.begin(warp, instruction, mask, faults);
  // The core's PC stays at an instruction that has not been executed; the RTL's instruction routine goes on behind it.
  if (instruction.kind != Kind::Control) plan_fetch(warp, now_ + 1, swap || faults || core_.in_triple(warp));
}

inline const Step& CycleUnit::execute(uint32_t warp, const DecodedInstruction& instruction) {
  if (tracing_) record_issue(warp, instruction);
  const Step& step = core_.step(warp);
  if (instruction.alu() == AluType::Mem) mem_.begin(step);
  if (tracing_) record_result(warp, step);
  ++counters_.single[counter::kInstructions];
  counters_.single[counter::kThreadInstructions] += popcount(step.mask);
  return step;
}

// What faults takes effect later: when its ALU finds it, or when it retires.
void CycleUnit::forget_fault() {
  core_.forget_fault();
  faulty_ = attention_ = true;
}

void CycleUnit::want(uint32_t warp, const DecodedInstruction& instruction) {
  const AluType type = instruction.alu();
  const uint32_t bit = 1u << warp;
  if (tracing_) timings_[warp].want_cycle = now_ + kAhead;
  if (type == AluType::Mem || type == AluType::Ray) {
    Timeline::Cycle& cycle = timeline_.at(now_ + kAhead);
    (type == AluType::Mem ? cycle.want_mem : cycle.want_ray) |= bit;
    if (instruction.next == nullptr) return;
    triples_ |= bit;
    followed_ |= type == AluType::Ray ? bit : 0;
    wants_left_[warp] = dones_left_[warp] = kElements - 1;
  } else if (instruction.next == nullptr) {
    dispatcher_.want(index(type), warp);
  } else {
    dispatcher_.want_triple(index(type), warp, type != AluType::Flt || instruction.elements_depend);
  }
}

// ---- Triples of Mem and Ray. Those of other types are the dispatcher's.

// Of the warps with a task done, those with the whole instruction done.
uint32_t CycleUnit::end_elements(uint32_t warps) {
  for (uint32_t triples = warps & triples_; triples != 0; triples &= triples - 1) {
    const uint32_t warp = lowest(triples);
    const uint32_t bit = 1u << warp;
    if (dones_left_[warp] == 0) {
      triples_ &= ~bit;
      continue;
    }
    --dones_left_[warp];
    warps &= ~bit;
    if ((mem_.done() & bit) != 0) next_load(warp);
  }
  return warps;
}

// A load waits for the one before.
void CycleUnit::next_load(uint32_t warp) {
  if (execute(warp, *core_.next_instruction(warp)).status == Step::Status::Fault) forget_fault();
  timeline_.at(now_ + kAhead).want_mem |= 1u << warp;
  if (tracing_) timings_[warp].want_cycle = now_ + kAhead;
}

// An access to ray memory is read while the one before is made.
void CycleUnit::grant_ray(bool ready) {
  const uint32_t bit = Dispatcher::winner(dispatcher_.wants(AluType::Ray), older_[kAhead]);
  if (tracing_ && ready) record_grant(AluType::Ray);
  dispatcher_.grant(AluType::Ray, ready, older_[kAhead], counters_);
  if (!ready || (followed_ & bit) == 0) return counters_.enter(counter::kWarpsInRay, now_ + 1, ready);
  timeline_.at(now_ + kAhead).want_ray |= bit;
  if (--wants_left_[lowest(bit)] == 0) followed_ &= ~bit;
  if (tracing_) record_next_want(bit);
}

// Only when a control instruction retires does the instruction routine go on.
void CycleUnit::retire_control(uint32_t warps) {
  for (; warps != 0; warps &= warps - 1) {
    const uint32_t warp = lowest(warps);
    if (stack_fault_[warp] != FaultCode::None) {
      raise({stack_fault_[warp], warp, buffer_.pc(warp)});
    } else if (!core_.warp_running(warp)) {
      buffer_.exit(warp);
      attention_ = true;
    } else {
      plan_fetch(warp, now_ + 1, false);
    }
  }
}

// ---- Faults

void CycleUnit::raise(const Fault& fault) {
  if (!halted()) raised_.push_back(fault);
  faulty_ = attention_ = true;
}

// Of warps that are done with an element: those with an element that has met a subnormal number.
uint32_t CycleUnit::raise_subnormals(uint32_t done) {
  uint32_t met = 0;
  for (; done != 0; done &= done - 1) {
    const uint32_t warp = lowest(done);
    if ((met_in_[warp] & 1) != 0) {
      raise({FaultCode::SubnormalNumber, warp, buffer_.pc(warp)});
      met |= 1u << warp;
    }
    met_in_[warp] = static_cast<uint8_t>(met_in_[warp] >> 1);
    if (met_in_[warp] == 0) met_subnormal_ &= ~(1u << warp);
  }
  return met;
}

// The first fault stays; of several in one cycle an ALU's wins, memory's before rays', then the lowest warp's.
void CycleUnit::settle_faults() {
  if (halted()) return;
  const AluFaults& alu = alu_faults_;
  for (const PlannedFault& planned_fault : planned_faults_) {
    if (planned_fault.cycle == now_) raise(planned_fault.fault);
  }
  // Of a warp's own the one of the instruction that is done, as the other is of a later one.
  std::sort(raised_.begin(), raised_.end(),
            [](const Fault& a, const Fault& b) { return a.warp != b.warp ? a.warp < b.warp : a.code > b.code; });
  if (alu.ray) raised_.insert(raised_.begin(), {FaultCode::RayWordOutside, alu.ray_warp, buffer_.pc(alu.ray_warp)});
  if (alu.mem != FaultCode::None) raised_.insert(raised_.begin(), {alu.mem, alu.mem_warp, buffer_.pc(alu.mem_warp)});
  if (raised_.empty()) return;
  fault_ = raised_.front();
  halt();
}

// From the next cycle on nothing is fetched or dispatched, but some cycles have been worked out already.
void CycleUnit::halt() {
  dispatcher_.halt();
  for (uint64_t cycle = now_ + 1; cycle < now_ + Timeline::kCycles; ++cycle) {
    Timeline::Cycle& due = timeline_.at(cycle);
    for (uint32_t warps = due.done | due.part; warps != 0; warps &= warps - 1) {
      const uint32_t warp = lowest(warps);
      const uint64_t depth = dispatcher_.depth(index(core_.instruction_at(buffer_.pc(warp))->alu()));
      if (cycle - depth <= now_ + 1) continue;
      due.done &= ~(1u << warp);
      due.part &= ~(1u << warp);
    }
  }
  if (instruction_cache_.missed() && miss_cycle_ > now_ + 1) instruction_cache_.forget_miss();
}

}  // namespace raypool
