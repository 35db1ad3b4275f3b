// The instruction routine, the dispatcher, the pipelined ALUs and what joins them.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "bits.hpp"
#include "isa/encoding.hpp"
#include "lockstep/inspection.hpp"
#include "lockstep/rtl_files.hpp"
#include "lockstep/text.hpp"
#include "machine/compute/brh_alu.hpp"

namespace raypool::lockstep {
namespace {

constexpr uint32_t kInstructionId = 16;

std::string scope_of(uint32_t unit) { return fmt::format("gen_unit[{}].compute_unit", unit); }

/// Instances of a type.
uint32_t count_of(const Configuration& configuration, size_t type) {
  return kAluTable[type].timed_by_events() ? 1 : configuration.alus[type].count;
}

std::string instance_scope(uint32_t unit, uint32_t instance) {
  return fmt::format("{}.gen_alu[{}]", scope_of(unit), instance);
}

/// The ALU of a type that a unit has one of.
std::string alu_scope(const Configuration& configuration, uint32_t unit, AluType type) {
  return fmt::format("{0}.gen_{1}.{1}_alu", instance_scope(unit, first_instance(configuration, type)),
                     alu_info(type).name);
}

}  // namespace

uint32_t first_instance(const Configuration& configuration, AluType type) {
  uint32_t instance = 0;
  for (size_t before = 0; before < static_cast<size_t>(type); ++before) instance += count_of(configuration, before);
  return instance;
}

UnitInspection::UnitInspection(const Configuration& configuration, const ComputeUnit& rtl, const CycleUnit& model,
                               uint32_t unit)
    : model_(&model),
      configuration_(configuration),
      warps_(configuration.warps),
      lanes_(configuration.lanes),
      warp_bits_(warps_ > 1 ? lowest(warps_) : 1),
      mshrs_(configuration.data_cache_mshrs),
      w_(rtl, scope_of(unit)),
      mem_(rtl, alu_scope(configuration, unit, AluType::Mem)),
      cache_(rtl, alu_scope(configuration, unit, AluType::Mem) + ".u_cache"),
      miss_(rtl, alu_scope(configuration, unit, AluType::Mem) + ".u_cache.u_miss_status"),
      sequencer_(rtl, alu_scope(configuration, unit, AluType::Mem) + ".u_sequencer"),
      ray_(rtl, alu_scope(configuration, unit, AluType::Ray)),
      instruction_cache_(configuration) {
  for (const std::string* missing :
       {&w_.missing, &mem_.missing, &cache_.missing, &miss_.missing, &sequencer_.missing, &ray_.missing}) {
    if (missing_.empty()) missing_ = *missing;
  }
  yielded_pc_.resize(warps_);
  for (uint32_t warp = 0; warp < warps_; ++warp) {
    stacks_.emplace_back(rtl, fmt::format("{}.gen_warp[{}].warp.pc_stack", scope_of(unit), warp),
                         configuration.stack_depth, configuration.pc_bits);
    if (missing_.empty()) missing_ = stacks_.back().missing();
  }
  for (uint32_t type = 0; type < kAluTypes; ++type) {
    const AluConfiguration alu = configuration.task_of(static_cast<AluType>(type));
    const bool piped = !kAluTable[type].timed_by_events();
    for (uint32_t number = 0; number < count_of(configuration, type); ++number) {
      const auto place = size32(instances_);
      task_.emplace_back(rtl, instance_scope(unit, place) + ".task_register");
      if (missing_.empty()) missing_ = task_.back().missing;
      Instance& instance = instances_.emplace_back();
      instance.type = type;
      instance.piped = piped;
      instance.latency = alu.latency;
      instance.depth = alu.depth;
      if (piped) piped_ |= 1u << place;
      if (piped && instance.latency > 1) paused_ |= 1u << place;
    }
  }
}

void UnitInspection::reset(uint32_t program_length) {
  program_length_ = program_length;
  findings_.clear();
  stopped_ = argument_written_ = alu_fault_ = lookup_ = false;
  fetch_turn_ = {};
  yielded_ = 0;
  for (PcStackRule& stack : stacks_) stack.reset();
  instruction_cache_.reset();
  requests_ = missed_ = first_ = wants_ = warp_faults_ = 0;
  port_ = {};
  before_ = {};
  tasks_ = parked_ = 0;
  done_.fill(0);
  for (Instance& instance : instances_) instance.ready_from = 0;
}

void UnitInspection::argument_written() {
  instruction_cache_.invalidate();
  argument_written_ = true;
}

void UnitInspection::find(const char* files, std::string text) {
  const auto same = [&](const Finding& finding) { return finding.files == files; };
  if (findings_.size() < kMostFindings && std::none_of(findings_.begin(), findings_.end(), same))
    findings_.push_back({now_, files, std::move(text)});
}

void UnitInspection::expect(uint32_t rtl, uint32_t expected, const char* files, const char* what) {
  if (rtl != expected)
    find(files, fmt::format("{}: {:x} in the RTL, {:x} by its rule (bits, hexadecimal)", what, rtl, expected));
}

void UnitInspection::advance(const UnitTransfers& given) {
  if (stopped_ || !active()) return;
  now_ = model_->now();
  warp_faults_ = w_.warp_fault.value();
  alu_fault_ = w_.mem_fault.value() != 0 || w_.ray_fault.value() != 0;
  advance_memory_port(given);
  advance_pc_stacks();
  advance_fetch(given);
  advance_instances();
  wants_ = w_.want.value() & ~w_.grant.value();
  before_ = given;
}

void UnitInspection::check() {
  if (stopped_ || !active()) return;
  now_ = model_->now();
  // What is wrong first: registers of a block, in the order in which blocks give to each
  // other, then what follows from them. A PC stack is held to its own inputs alone, so whatever it does wrong is its
  // own.
  check_pc_stacks();
  check_faults();
  check_launch();
  check_memory_port();
  check_memory_alu();
  check_ray_alu();
  check_instruction_cache();
  check_tasks();
  check_done();
  check_retired();
  const bool faulty = w_.fault_valid_o.value() != 0 || model_->outputs().fault.code != FaultCode::None;
  if (!faulty) {
    check_fetch();
    check_fetch_arbiter();
    check_wants();
    check_ready();
    check_dispatch();
  }
  stopped_ = faulty || !findings_.empty();
}

// ---- Launch and faults

void UnitInspection::check_launch() {
  const bool running = model_->outputs().busy != 0;
  expect(w_.waiting_launch.value(), model_->launcher().waiting(), "rtl/compute/rp_launcher.v", "a launch waits");
  expect(w_.busy_o.value(), running, "rtl/compute/rp_launcher.v", "a kernel runs");
  expect(w_.active.value(), model_->active_warps(), "rtl/compute/rp_instruction_buffer.v, rtl/compute/rp_launcher.v",
         "warps that run");
  expect(w_.kernel_done_o.value(), model_->outputs().kernel_done, "rtl/compute/rp_launcher.v", "the kernel's end");
  if (running) {
    const LaunchCommand& launched = model_->launcher().newest();
    const uint32_t place = model_->launcher().registers().newest;
    if (w_.threads.bits(11 * place, 11) != launched.threads || w_.block.bits(32 * place, 32) != launched.block ||
        w_.blocks.bits(32 * place, 32) != launched.blocks)
      find("rtl/compute/rp_launcher.v", "threads, block or blocks of the launch that runs are wrong");
  }
  const uint32_t warps = model_->launcher().starts(model_->active_warps());
  expect(w_.start.value(), warps, "rtl/compute/rp_launcher.v", "warps that are started");
  if (warps == 0) return;
  const LaunchCommand& started = model_->launcher().start_launch();
  expect(w_.start_pc.value(), started.pc, "rtl/compute/rp_launcher.v", "PC of the start");
  for (uint32_t thread = 0; thread < warps_ * lanes_; ++thread)
    expect(w_.start_lanes.flag(thread), thread < started.threads, "rtl/compute/rp_launcher.v", "lane that is started");
}

// The guard looks at what the ALU has taken and made; the ALU decides which of an instruction's operands and lanes that
// is, and when.
std::string UnitInspection::subnormal_files(uint32_t warp) const {
  const DecodedInstruction* instruction = warp < warps_ ? model_->issue(warp).instruction : nullptr;
  if (instruction == nullptr || !instruction->legal()) return "rtl/compute/rp_subnormal_guard.v, rtl/compute/rp_warp.v";
  return rtl_files({std::string(alu_info(instruction->alu()).name) + "_alu", "subnormal_guard"});
}

void UnitInspection::check_faults() {
  const Fault& expected = model_->outputs().fault;
  Fault rtl;
  if (w_.fault_valid_o.value() != 0)
    rtl = {static_cast<FaultCode>(w_.fault_code_o.value()), w_.fault_warp_o.value(), w_.fault_pc_o.value()};
  if (rtl.code == expected.code &&
      (rtl.code == FaultCode::None || (rtl.warp == expected.warp && rtl.pc == expected.pc)))
    return;
  const FaultCode code = expected.code == FaultCode::None ? rtl.code : expected.code;
  const bool of_alu = code >= FaultCode::Misaligned && code <= FaultCode::RayWordOutside;
  const bool raised =
      of_alu ? alu_fault_ : (warp_faults_ >> (expected.code == FaultCode::None ? rtl.warp : expected.warp) & 1) != 0;
  // Of one warp and of one kind of ALU: the block that raises it gives code and PC.
  const bool of_rtl_alu = rtl.code >= FaultCode::Misaligned && rtl.code <= FaultCode::RayWordOutside;
  const bool same_raiser = rtl.code != FaultCode::None && expected.code != FaultCode::None &&
                           rtl.warp == expected.warp && of_rtl_alu == of_alu;
  if (raised == (expected.code != FaultCode::None) && !same_raiser)
    return find("rtl/compute/rp_compute_unit.v", "the fault that was raised is not the one shown");
  const bool other_pc = same_raiser && rtl.code == expected.code;
  const char* files =
      other_pc ? "rtl/compute/rp_warp.v, rtl/compute/rp_compute_unit.v, rtl/compute/rp_instruction_buffer.v"
      : code == FaultCode::IllegalInstruction ? "rtl/compute/rp_instruction_buffer.v, rtl/include/rp_isa_functions.vh"
      : code == FaultCode::PcOutsideProgram   ? "rtl/compute/rp_instruction_buffer.v, rtl/compute/rp_warp.v"
      : code <= FaultCode::StackUnderflow     ? "rtl/compute/rp_warp.v, rtl/compute/rp_pc_stack.v"
      : code == FaultCode::RayWordOutside     ? "rtl/compute/rp_ray_alu.v"
                                              : "rtl/compute/rp_mem_alu.v";
  const char* text = expected.code == FaultCode::None ? "a fault is raised that is none"
                     : same_raiser                    ? "another fault is raised, or at another PC"
                                                      : "a fault is not raised";
  if (code == FaultCode::SubnormalNumber)
    find(subnormal_files(expected.code == FaultCode::None ? rtl.warp : expected.warp).c_str(), text);
  else
    find(files, text);
}

// ---- The memory port of the unit

void UnitInspection::advance_memory_port(const UnitTransfers& given) {
  Port now;
  now.valid = w_.memory_request_valid_o.value() != 0;
  if (now.valid && !given.request_ready) {
    now.write = w_.memory_request_write_o.value() != 0;
    now.address = w_.memory_request_address_o.value();
    now.id = w_.memory_request_id_o.value();
    now.mask = w_.memory_request_mask_o.value();
    for (uint32_t i = 0; i < kBeatWords; ++i) now.data[i] = w_.memory_request_data_o.word(i);
    port_ = now;
    return;
  }
  port_ = {};
  if (w_.instruction_request.value() != 0) {
    port_.valid = true;
    port_.address = w_.instruction_request_address.value();
    port_.id = kInstructionId;
  } else if (w_.data_request.value() != 0) {
    port_.valid = true;
    port_.write = w_.data_request_write.value() != 0;
    port_.address = w_.data_request_address.value();
    port_.id = w_.data_request_id.value();
    port_.mask = w_.data_request_mask.value();
    for (uint32_t i = 0; i < kBeatWords; ++i) port_.data[i] = w_.data_request_data.word(i);
  }
}

void UnitInspection::check_memory_port() {
  bool same = (w_.memory_request_valid_o.value() != 0) == port_.valid;
  if (same && port_.valid) {
    same =
        (w_.memory_request_write_o.value() != 0) == port_.write && w_.memory_request_address_o.value() == port_.address;
    if (port_.write) {
      same = same && w_.memory_request_mask_o.value() == port_.mask;
      for (uint32_t i = 0; i < kBeatWords; ++i) same = same && w_.memory_request_data_o.word(i) == port_.data[i];
    } else {
      same = same && w_.memory_request_id_o.value() == port_.id;
    }
  }
  if (!same)
    find("rtl/compute/rp_memory_arbiter.v, rtl/compute/rp_unit_memory_arbiter.v",
         "the memory port shows another request than was handed to it");
}

// ---- The instruction routine

void UnitInspection::advance_pc_stacks() {
  yielded_ = 0;
  for (uint32_t warp = 0; warp < warps_; ++warp) {
    PcStackRule& stack = stacks_[warp];
    const bool start = (w_.start.value() >> warp & 1) != 0;
    if (stack.yields() && !start) {
      yielded_ |= 1u << warp;
      yielded_pc_[warp] = stack.pc();
    }
    stack.take(start, w_.start_pc.value());
  }
}

void UnitInspection::check_pc_stacks() {
  for (uint32_t warp = 0; warp < warps_; ++warp) {
    const char* broken = stacks_[warp].broken();
    if (broken != nullptr)
      find("rtl/compute/rp_pc_stack.v",
           fmt::format("PC stack of warp {} (depth {} by its rule): {}", warp, stacks_[warp].depth(), broken));
  }
  for (uint32_t rest = yielded_; rest != 0; rest &= rest - 1) {
    const uint32_t warp = lowest(rest);
    const uint32_t pc = w_.fetch_pc.bits(warp * 16, 16);
    if (pc != yielded_pc_[warp])
      find("rtl/compute/rp_instruction_buffer.v, rtl/compute/rp_warp.v, rtl/compute/rp_compute_unit.v",
           fmt::format("warp {} fetches PC {}, its PC stack has given {}", warp, pc, yielded_pc_[warp]));
  }
}

void UnitInspection::advance_fetch(const UnitTransfers& given) {
  requests_ = w_.fetch_request.value() & ~w_.fetch_grant.value();
  const bool missed = w_.instruction_miss.value() != 0;
  const uint32_t warp = w_.result_warp.value();
  if (missed) missed_ |= 1u << warp;
  refilled_ = 0;
  if (w_.refill_done.value() != 0) {
    refilled_ = missed_;
    requests_ |= missed_;
    missed_ = 0;
  }
  const bool port_free = w_.memory_request_valid_o.value() == 0 || given.request_ready;
  const bool last_beat = given.response && given.response_id == kInstructionId && given.response_beat == 3;
  instruction_cache_.clock(now_, missed, port_free, last_beat);
  lookup_ = w_.fetch_valid.value() != 0;
  if (lookup_) {
    lookup_warp_ = w_.fetch_warp.value();
    lookup_pc_ = w_.lookup_pc.value();
    lookup_hit_ = instruction_cache_.lookup(lookup_warp_, lookup_pc_);
  }
  instruction_cache_.end_cycle();
  first_ = instruction_cache_.first(now_ + 1);
}

void UnitInspection::check_instruction_cache() {
  const char* files = argument_written_ && w_.instruction_hit.value() != 0
                          ? "rtl/compute/rp_instruction_cache.v, rtl/compute/rp_compute_unit.v"
                          : "rtl/compute/rp_instruction_cache.v";
  expect(w_.instruction_hit.value(), lookup_ && lookup_hit_, files, "instruction cache, hit");
  expect(w_.instruction_miss.value(), lookup_ && !lookup_hit_, files, "instruction cache, miss");
  if (lookup_) expect(w_.result_warp.value(), lookup_warp_, files, "instruction cache, warp of the result");
  const DecodedInstruction* expected = model_->core().instruction_at(lookup_pc_);
  if (lookup_ && lookup_hit_ && expected != nullptr &&
      (w_.fetched.word(0) != static_cast<uint32_t>(expected->encoding) ||
       w_.fetched.word(1) != expected->encoding >> 32))
    find(files, fmt::format("instruction cache: {:08x}{:08x} at PC {}, memory has {:016x}", w_.fetched.word(1),
                            w_.fetched.word(0), lookup_pc_, expected->encoding));
  expect(w_.refill_done.value(), instruction_cache_.refill_done(), files, "instruction cache, a line has come");
  expect(w_.fetch_first.value(), first_, files, "instruction cache, the warp to look up first");
  expect(w_.instruction_request.value(), instruction_cache_.request_valid(), files, "instruction cache, request");
  if (instruction_cache_.request_valid())
    expect(w_.instruction_request_address.value(), instruction_cache_.request_address(), files,
           "instruction cache, address");
}

// Warps come to the fetch arbiter when they do in the model, with its PC, or again when a line has come.
void UnitInspection::check_fetch() {
  for (uint32_t warp = 0; warp < warps_; ++warp) {
    const CycleUnit::Timing& next = model_->timing(warp);
    if (next.fetch_cycle != now_ || next.fetch_pc >= program_length_) continue;
    requests_ |= 1u << warp;
    // One that does not want yet has perhaps not gone on to it.
    if ((w_.fetch_request.value() >> warp & 1) != 0 && w_.fetch_pc.bits(warp * 16, 16) != next.fetch_pc) {
      find("rtl/compute/rp_warp.v, rtl/compute/rp_instruction_buffer.v",
           fmt::format("warp {} fetches PC {}, after its last instruction comes {}", warp,
                       w_.fetch_pc.bits(warp * 16, 16), next.fetch_pc));
    }
  }
  const uint32_t rtl = w_.fetch_request.value();
  for (uint32_t warps = rtl ^ requests_; warps != 0; warps &= warps - 1) {
    const uint32_t warp = lowest(warps);
    const bool early = (rtl >> warp & 1) != 0;
    // Warps that wait for a line are woken when it has come.
    find((refilled_ >> warp & 1) != 0 ? "rtl/compute/rp_instruction_buffer.v, rtl/compute/rp_compute_unit.v"
                                      : "rtl/compute/rp_instruction_buffer.v, rtl/compute/rp_warp.v",
         early ? fmt::format("warp {} asks the instruction cache too early", warp)
               : fmt::format("warp {} does not ask the instruction cache for PC {} in time", warp,
                             model_->timing(warp).fetch_pc));
  }
}

void UnitInspection::check_fetch_arbiter() {
  const uint32_t requests = w_.fetch_request.value();
  if ((requests | w_.fetch_grant.value() | w_.fetch_valid.value()) == 0) return;
  const uint32_t first = requests & w_.fetch_first.value();
  uint32_t grant = first;
  if (first == 0 && requests != 0) {
    const uint32_t choice = fetch_turn_.choose(requests);
    grant = 1u << choice;
    fetch_turn_.advance(choice);
  }
  expect(w_.fetch_grant.value(), grant, "rtl/compute/rp_fetch_arbiter.v, rtl/common/rp_round_robin.v",
         "fetch arbiter, grant");
  expect(w_.fetch_valid.value(), requests != 0, "rtl/compute/rp_fetch_arbiter.v", "fetch arbiter, valid");
  if (grant == 0) return;
  expect(w_.fetch_warp.value(), lowest(grant), "rtl/compute/rp_fetch_arbiter.v", "fetch arbiter, warp");
  expect(w_.lookup_pc.value(), w_.fetch_pc.bits(lowest(grant) * 16, 16), "rtl/compute/rp_compute_unit.v",
         "PC that is looked up");
}

// ---- From the instruction buffer to dispatch

void UnitInspection::check_wants() {
  for (uint32_t warp = 0; warp < warps_; ++warp) {
    if (model_->timing(warp).want_cycle != now_) continue;
    wants_ |= 1u << warp;
    check_operands(warp);
  }
  expect(w_.want.value(), wants_, "rtl/compute/rp_instruction_buffer.v, rtl/compute/rp_warp.v",
         "warps that want an ALU");
}

void UnitInspection::check_operands(uint32_t warp) {
  const CycleUnit::Issue& issue = model_->wanting(warp);
  const uint64_t encoding = issue.instruction->encoding;
  const uint32_t low = w_.retire_instruction_o.word(warp * 2), high = w_.retire_instruction_o.word(warp * 2 + 1);
  const uint32_t pc = w_.retire_pc_o.bits(warp * 16, 16);
  if (pc != issue.pc || low != static_cast<uint32_t>(encoding) || high != encoding >> 32)
    return find("rtl/compute/rp_instruction_buffer.v, rtl/compute/rp_warp.v",
                fmt::format("warp {}: not the instruction, or not the PC, that was fetched", warp));
  const auto uses = [&](TaskOperand operand) { return looks_at(*issue.instruction->info, operand); };
  const auto lanes_of = [&](const Wire& wire) { return wire.bits(warp * lanes_, lanes_); };
  const uint32_t all = lanes_ == 32 ? ~0u : (1u << lanes_) - 1;
  const char* predicates = "rtl/compute/rp_predicate_file.v, rtl/compute/rp_warp.v";
  expect(lanes_of(w_.retire_mask_o), issue.mask, predicates, "thread mask that was read");
  if (uses(TaskOperand::PredicateX))
    expect(lanes_of(w_.predicate_x), issue.predicate_x & all, predicates, "predicate px that was read");
  if (uses(TaskOperand::PredicateB))
    expect(lanes_of(w_.predicate_b), issue.predicate_b & all, predicates, "predicate pb that was read");
  for (uint32_t mask = issue.mask; mask != 0; mask &= mask - 1) {
    const uint32_t lane = lowest(mask);
    const uint32_t row = warp * lanes_ + lane;
    const bool reads_b = uses(TaskOperand::OperandB) && !issue.instruction->b_is_immediate;
    const bool same = (!uses(TaskOperand::OperandA) || w_.operand_a.word(row) == issue.operand_a[lane]) &&
                      (!reads_b || w_.operand_b.word(row) == issue.operand_b[lane]) &&
                      (!uses(TaskOperand::OperandC) || w_.operand_c.word(row) == issue.operand_c[lane]);
    // Of a triple the instruction buffer chooses the element that is read.
    const bool triple = is_triple(*unpack(encoding).info);
    if (!same)
      return find(triple ? "rtl/compute/rp_warp.v, rtl/compute/rp_instruction_buffer.v"
                         : "rtl/compute/rp_warp.v, rtl/common/rp_ram_2r1w.v",
                  fmt::format("warp {}, lane {}: a register was read wrong", warp, lane));
  }
}

// ---- Dispatcher and task registers

void UnitInspection::check_tasks() {
  for (uint32_t i = 0; i < instances_.size(); ++i) {
    const bool expected = (tasks_ >> i & 1) != 0;
    expect(task_[i].task_valid_o.value(), expected, "rtl/compute/rp_task_register.v, rtl/compute/rp_dispatcher.v",
           "an instance gets a task");
    if (expected && task_[i].task_valid_o.value() != 0) check_task(i, instances_[i].task, *instances_[i].issue);
  }
}

void UnitInspection::check_task(uint32_t instance, uint32_t warp, const CycleUnit::Issue& issue) {
  const TaskWires& task = task_[instance];
  const DecodedInstruction& instruction = *issue.instruction;
  const auto uses = [&](TaskOperand operand) { return looks_at(*instruction.info, operand); };
  const char* differs = nullptr;
  const auto compare = [&](bool used, uint32_t rtl, uint32_t expected, const char* what) {
    if (used && rtl != expected && differs == nullptr) differs = what;
  };
  compare(true, task.task_warp_o.value(), warp, "warp");
  compare(true, task.task_operation_o.value(), operation_of(instruction.opcode), "operation");
  compare(true, task.task_mask_o.value(), issue.mask, "thread mask");
  // Of an argument's number no more bits count than it has, whatever an element of a triple adds to them.
  const uint32_t counts = instruction.opcode == Opcode::Arg ? kArguments - 1 : ~0u;
  compare(uses(TaskOperand::Immediate), task.task_immediate_o.value() & counts, instruction.immediate & counts,
          "immediate");
  compare(uses(TaskOperand::Word), task.task_word_o.value(), instruction.x, "word number");
  compare(uses(TaskOperand::PredicateX), task.task_predicate_x_o.value() & issue.mask, issue.predicate_x & issue.mask,
          "predicate px");
  compare(uses(TaskOperand::PredicateB), task.task_predicate_b_o.value() & issue.mask, issue.predicate_b & issue.mask,
          "predicate pb");
  for (uint32_t mask = issue.mask; differs == nullptr && mask != 0; mask &= mask - 1) {
    const uint32_t lane = lowest(mask);
    compare(uses(TaskOperand::OperandA), task.task_operand_a_o.word(lane), issue.operand_a[lane], "operand a");
    compare(uses(TaskOperand::OperandB), task.task_operand_b_o.word(lane), issue.operand_b[lane], "operand b");
    compare(uses(TaskOperand::OperandC), task.task_operand_c_o.word(lane), issue.operand_c[lane], "operand c");
  }
  if (differs == nullptr) return;
  // Of a triple the warp works out the element.
  const bool triple = is_triple(*unpack(instruction.encoding).info);
  const bool other_warp = task.task_warp_o.value() != warp;
  find(other_warp ? "rtl/compute/rp_dispatcher.v, rtl/compute/rp_task_register.v"
       : triple   ? "rtl/compute/rp_task_register.v, rtl/compute/rp_warp.v"
                  : "rtl/compute/rp_task_register.v",
       fmt::format("instance {}: the task is not that of warp {}: {}, the {} differs", instance, warp,
                   instruction.info->mnemonic, differs));
}

void UnitInspection::check_ready() {
  uint32_t ready = piped_;
  for (uint32_t rest = paused_; rest != 0; rest &= rest - 1) {
    if (now_ < instances_[lowest(rest)].ready_from) ready &= ~(1u << lowest(rest));
  }
  const uint32_t wrong = (ready ^ w_.ready.value()) & piped_;
  if (wrong != 0) {
    const std::string files =
        rtl_files({"alu_pipeline", std::string(kAluNames[instances_[lowest(wrong)].type]) + "_alu"});
    find(files.c_str(), "the ALU takes its next task too early or too late");
  }
}

// Each free instance takes the lowest warp that wants its type.
void UnitInspection::check_dispatch() {
  uint32_t left = w_.want.value(), granted = 0;
  const uint32_t ready = w_.ready.value();
  tasks_ = 0;
  for (uint32_t i = 0; left != 0 && i < instances_.size(); ++i) {
    if ((ready >> i & 1) == 0) continue;
    const uint32_t first = model_->first_warps();
    for (uint32_t n = 0; n < 2 * warps_; ++n) {  // those that go first, then the others
      const uint32_t warp = n % warps_;
      if ((left >> warp & 1) == 0 || ((first >> warp & 1) != 0) != (n < warps_)) continue;
      if (w_.wanted_type.bits(warp * field::kType.bits, field::kType.bits) != instances_[i].type) continue;
      instances_[i].task = warp;
      instances_[i].issue = &model_->wanting(warp);
      left &= ~(1u << warp);
      granted |= 1u << warp;
      tasks_ |= 1u << i;
      break;
    }
  }
  expect(w_.grant.value(), granted, "rtl/compute/rp_dispatcher.v", "dispatcher, warps that are granted");
  expect(w_.instance_grant.value(), tasks_, "rtl/compute/rp_dispatcher.v",
         "dispatcher, instances that are given a task");
}

// ---- ALUs

void UnitInspection::advance_instances() {
  done_[now_ % kRing] = 0;
  for (uint32_t rest = piped_; rest != 0; rest &= rest - 1) {
    const TaskWires& task = task_[lowest(rest)];
    if (task.task_valid_o.value() == 0) continue;
    Instance& instance = instances_[lowest(rest)];
    done_[(now_ + instance.depth) % kRing] |= 1u << lowest(rest);
    instance.under_way[(now_ + instance.depth) % kRing] = static_cast<uint8_t>(task.task_warp_o.value());
  }
  for (uint32_t rest = w_.instance_grant.value() & paused_; rest != 0; rest &= rest - 1)
    instances_[lowest(rest)].ready_from = now_ + instances_[lowest(rest)].latency;
}

void UnitInspection::check_done() {
  const uint32_t done = w_.done_valid.value(), expected = done_[now_ % kRing];
  for (uint32_t rest = done | expected; rest != 0; rest &= rest - 1) {
    const uint32_t i = lowest(rest);
    const Instance& instance = instances_[i];
    const uint32_t warp = warp_field(w_.done_warp, i);
    const bool in_time = ((done ^ expected) >> i & 1) == 0 && instance.under_way[now_ % kRing] == warp;
    if (instance.piped && !in_time) {
      const std::string files = rtl_files({"alu_pipeline", std::string(kAluNames[instance.type]) + "_alu"});
      find(files.c_str(), "the ALU is done too early or too late, or with another warp");
    } else if (warp < warps_ && model_->issue(warp).instruction != nullptr) {
      check_result(i, warp);
    }
  }
}

void UnitInspection::check_result(uint32_t instance, uint32_t warp) {
  const CycleUnit::Issue& issue = model_->issue(warp);
  const DecodedInstruction& instruction = *issue.instruction;
  if (to_underlying(instruction.alu()) != instances_[instance].type) return;
  bool same = true;
  if (instruction.writes_register) {
    for (uint32_t mask = issue.mask; same && mask != 0; mask &= mask - 1)
      same = w_.done_data.word(instance * lanes_ + lowest(mask)) == issue.data[lowest(mask)];
  } else if (instruction.writes_predicate) {
    same = (w_.done_predicate.bits(instance * lanes_, lanes_) & issue.mask) == issue.predicate;
  } else if (instruction.kind == Kind::Control) {
    const bool taken = BrhAlu::taken(instruction.opcode, issue.mask);
    same = w_.done_predicate.flag(instance * lanes_) == taken;
  }
  if (!same) {
    find(result_files(instruction, configuration_).c_str(),
         fmt::format("warp {}: {} was given the right operands and has another result", warp,
                     instruction.info->mnemonic));
  }
}

void UnitInspection::check_retired() {
  uint32_t retired = 0;
  for (uint32_t rest = w_.done_valid.value(); rest != 0; rest &= rest - 1) {
    const uint32_t i = lowest(rest);
    const uint32_t warp = warp_field(w_.done_warp, i);
    retired |= 1u << warp;
    for (uint32_t lane = 0; lane < lanes_; ++lane) {
      if (w_.retire_data_o.word(warp * lanes_ + lane) != w_.done_data.word(i * lanes_ + lane))
        return find("rtl/compute/rp_warp.v", fmt::format("warp {} takes another result than that of its ALU", warp));
    }
  }
  expect(w_.retire_valid_o.value(), retired, "rtl/compute/rp_warp.v, rtl/compute/rp_compute_unit.v",
         "warps that retire");
}

}  // namespace raypool::lockstep
