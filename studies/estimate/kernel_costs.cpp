#include "estimate/kernel_costs.hpp"

#include <algorithm>
#include <string>

#include "isa/encoding.hpp"
#include "kernel/kernel_report.hpp"

namespace raypool::estimate {
namespace {

// Cycles of an instruction beside those in its ALU: instruction buffer, registers, dispatch, and the result's.
constexpr double kStages = 3;
// The next instruction is fetched when a control instruction is done: PC stack, arbiter, cache, buffer.
constexpr double kFetch = 4;
// A swap of ray memory that need not wait; a load whose lanes share a quadword that is there.
constexpr double kSwap = 2, kLoad = 3;

struct Timing {
  double depth, occupied;
};

Timing timing_of(const InstructionInfo& info, const Configuration& configuration) {
  if (info.alu() == AluType::Mem) return {kLoad, 1};
  if (info.alu() != AluType::Ray) {
    const AluConfiguration task = configuration.task_of(info.alu());
    return {static_cast<double>(task.depth), static_cast<double>(task.latency)};
  }
  if (info.kind == Kind::Swap) return {kSwap, 0};
  const double access = configuration.ray_access_cycles();
  return {1 + access, access};
}

Exchange exchange_of(Opcode opcode) {
  return opcode == Opcode::Rin ? Exchange::Import : opcode == Opcode::Rfb ? Exchange::Contribute : Exchange::ExportRays;
}

/// Cycles until the last element's result: each behind the other's, or, where elements overlap, two cycles or the
/// ALU's occupation behind.
double serial_of(const InstructionInfo& info, const Timing& timing) {
  if (!is_triple(info)) return kStages + timing.depth;
  const bool overlap = info.alu() == AluType::Flt || info.alu() == AluType::Ray;
  const double behind = overlap ? std::max(2.0, timing.occupied) : kStages + timing.depth - 1;
  return kStages + timing.depth + (kElements - 1) * behind;
}

}  // namespace

KernelCosts costs_of(const Program& program, std::string_view name, const Configuration& configuration) {
  KernelCosts costs;
  costs.segments.emplace_back();
  for (const uint64_t encoding : extract_kernel(program, std::string(name)).code) {
    const Instruction parts = unpack(encoding);
    if (parts.info == nullptr) continue;
    const InstructionInfo& info = *parts.info;
    const Timing timing = timing_of(info, configuration);
    const double elements = is_triple(info) ? kElements : 1;
    Segment& segment = costs.segments.back();
    segment.serial += serial_of(info, timing) + (info.kind == Kind::Control ? kFetch : 0);
    segment.instructions += 1;
    segment.tasks[info.alu()] += elements;
    segment.busy[info.alu()] += elements * timing.occupied;
    if (info.kind != Kind::Swap) continue;
    costs.exchanges.push_back(exchange_of(info.opcode));
    costs.segments.emplace_back();
  }
  costs.exchanges.push_back(Exchange::End);
  return costs;
}

}  // namespace raypool::estimate
