#include "lockstep/comparison.hpp"

#include <fmt/format.h>

#include "bits.hpp"
#include "lockstep/text.hpp"
#include "machine/compute/warp_cycles.hpp"

namespace raypool::lockstep {
namespace {

constexpr const char* kMemoryModules =
    "rtl/compute/rp_mem_alu.v, rtl/compute/rp_data_cache.v, rtl/compute/rp_memory_arbiter.v";
constexpr const char* kFetchModules = "rtl/compute/rp_instruction_cache.v, rtl/compute/rp_memory_arbiter.v";
constexpr const char* kImportModules =
    "rtl/compute/rp_ray_import.v, rtl/compute/rp_ray_alu.v, rtl/compute/rp_import_arbiter.v";
constexpr const char* kExportModules =
    "rtl/compute/rp_ray_export.v, rtl/compute/rp_ray_alu.v, rtl/compute/rp_ray_memory.v";
constexpr const char* kExportCountModules =
    "rtl/compute/rp_ray_alu.v, rtl/compute/rp_compute_unit.v, rtl/compute/rp_multiprocessor.v";

// A row of a table of what differs.
template <typename Value>
std::string row(const char* name, const Value& rtl, const Value& model) {
  return fmt::format("  {:<24} RTL {:<24} model {:<24}{}\n", name, rtl, model, rtl == model ? "" : "  <-- differs");
}

std::string quadword_line(const char* engine, uint32_t address, uint32_t mask, const Beat& data) {
  std::string text = fmt::format(" {:<5} {:08x}, word mask {}:", engine, address, mask_text(mask, kBeatWords));
  for (uint32_t i = 0; i < kBeatWords; ++i) text += mask >> i & 1 ? ' ' + word_text(data[i]) : " -";
  return text + '\n';
}

bool same_words(const Beat& a, const Beat& b, uint32_t mask) {
  for (uint32_t i = 0; i < kBeatWords; ++i) {
    if (mask >> i & 1 && a[i] != b[i]) return false;
  }
  return true;
}

std::string beat_rows(const Beat& rtl, const Beat& model) {
  std::string text;
  for (size_t i = 0; i < kBeatWords; ++i)
    text += row(fmt::format("word {}", i).c_str(), word_text(rtl[i]), word_text(model[i]));
  return text;
}

std::string retired_line(const char* engine, const RetireEvent& event) {
  return fmt::format(" {:<5} PC {:>5}: {}\n", engine, event.pc, instruction_text(event.instruction));
}

// What gives a performance counter its events.
const char* source_of_events(int number) {
  if (number >= counter::kUnused) return "rtl/compute/rp_dispatcher.v";
  if (number >= counter::kWarpsInRay) return "rtl/compute/rp_ray_alu.v";
  if (number == counter::kWarpsNotLaunched) return "rtl/compute/rp_launcher.v";
  if (number >= counter::kWarpsEnded) return "rtl/compute/rp_instruction_buffer.v";
  return number >= counter::kDataCacheHits ? "rtl/compute/rp_mem_alu.v" : "rtl/common/rp_event_counter.v";
}

// A unit that calls itself idle too early has overlooked what still waits at a port.
const char* launch_files(const UnitOutputs& rtl, const UnitOutputs& model) {
  const bool only_idle = rtl.launch_ready == model.launch_ready && rtl.kernel_done == model.kernel_done &&
                         rtl.busy == model.busy && rtl.launch_unit == model.launch_unit;
  if (!only_idle) return "rtl/compute/rp_launcher.v, rtl/compute/rp_compute_unit.v";
  if (model.memory_request_valid)
    return "rtl/compute/rp_memory_arbiter.v, rtl/compute/rp_compute_unit.v, rtl/compute/rp_mem_alu.v";
  if (model.export_valid || model.frame_valid)
    return "rtl/compute/rp_compute_unit.v, rtl/compute/rp_ray_export.v, rtl/compute/rp_ray_alu.v";
  return "rtl/compute/rp_compute_unit.v, rtl/compute/rp_mem_alu.v, rtl/compute/rp_launcher.v";
}

bool is_fetch(const MemoryRequest& request) { return !request.write && (request.id & 31) == 16; }

template <typename Event>
bool before(const Event& a, const Event& b) {
  return a.unit != b.unit ? a.unit < b.unit : a.warp < b.warp;
}

// Events of both sides, in the order of unit and warp: `both` for a pair, `one` for one that the other side has not.
template <typename Event, typename Both, typename One>
void pair_up(const std::vector<Event>& rtl, const std::vector<Event>& model, Both both, One one) {
  size_t r = 0, m = 0;
  while (r < rtl.size() || m < model.size()) {
    if (m == model.size() || (r < rtl.size() && before(rtl[r], model[m]))) {
      one(rtl[r++], true);
    } else if (r == rtl.size() || before(model[m], rtl[r])) {
      one(model[m++], false);
    } else {
      both(rtl[r++], model[m++]);
    }
  }
}

// Where all that differ count the events of one block, that block is likelier than what counts them.
std::string counter_files(ComputeUnit& rtl, ComputeUnit& model, int first) {
  const std::string source = source_of_events(first);
  bool one_source = source != "rtl/common/rp_event_counter.v";
  for (int number = 0; number < counter::kCount; ++number)
    one_source = one_source && (rtl.counter(number) == model.counter(number) || source == source_of_events(number));
  if (rtl.units() > 1) return "rtl/compute/rp_performance_counters.v, rtl/compute/rp_multiprocessor.v, " + source;
  return one_source ? source + ", rtl/compute/rp_performance_counters.v"
                    : "rtl/compute/rp_performance_counters.v, " + source;
}

}  // namespace

void Comparison::trace(const UnitTrace& rtl, const UnitTrace& model) {
  const auto other_cycle = [](const char* what, const char* module) {
    return [what, module](const auto& event, bool in_rtl) {
      throw Mismatch{fmt::format("warp {} {} in this cycle in {}, and not in {}", event.warp, what,
                                 in_rtl ? "the RTL" : "the model", in_rtl ? "the model" : "the RTL"),
                     "",
                     module,
                     Context::Operands,
                     event.unit,
                     event.warp};
    };
  };
  pair_up(
      rtl.stores, model.stores, [this](const auto& r, const auto& m) { store(r, m); },
      other_cycle("stores", kMemoryModules));
  pair_up(
      rtl.ray_writes, model.ray_writes, [this](const auto& r, const auto& m) { ray_write(r, m); },
      other_cycle("writes ray memory", "rtl/compute/rp_ray_alu.v"));
  pair_up(
      rtl.retired, model.retired, [this](const auto& r, const auto& m) { retirement(r, m); },
      [this](const auto& event, bool in_rtl) { only_one(event, in_rtl); });
}

void Comparison::only_one(const RetireEvent& event, bool in_rtl) const {
  const DecodedInstruction instruction = decode(event.instruction, configuration_);
  throw Mismatch{
      fmt::format("warp {} retires an instruction in this cycle in {}, and not in {}", event.warp,
                  in_rtl ? "the RTL" : "the model", in_rtl ? "the model" : "the RTL"),
      retired_line(in_rtl ? "RTL" : "model", event),
      instruction.legal() && alu_info(instruction.info->alu()).timed_by_events()
          ? result_files(instruction, configuration_)
          : "rtl/compute/rp_fetch_arbiter.v, rtl/compute/rp_instruction_buffer.v, rtl/compute/rp_dispatcher.v",
      Context::Warp,
      event.unit,
      event.warp};
}

void Comparison::retirement(const RetireEvent& rtl, const RetireEvent& model) {
  const auto differs = [&rtl](std::string title, std::string details, std::string module, Context context) {
    return Mismatch{std::move(title), std::move(details), std::move(module), context, rtl.unit, rtl.warp};
  };
  const auto both = [&] { return retired_line("RTL", rtl) + retired_line("model", model); };
  if (rtl.pc != model.pc) {
    throw differs(fmt::format("warp {} retired another PC than the model's", rtl.warp), both(),
                  "rtl/compute/rp_pc_stack.v, rtl/compute/rp_brh_alu.v", Context::Warp);
  }
  if (rtl.instruction != model.instruction) {
    throw differs(fmt::format("warp {} executed another instruction than lies in memory at PC {}", rtl.warp, rtl.pc),
                  both() + fmt::format("  encoding: RTL {:016x}, memory {:016x}\n", rtl.instruction, model.instruction),
                  "rtl/compute/rp_instruction_cache.v, rtl/compute/rp_instruction_buffer.v", Context::Warp);
  }
  const CycleUnit::Issue& issue = issue_(rtl.unit, rtl.warp);
  const auto masks = [&](uint32_t r, uint32_t m) {
    return fmt::format("  RTL   {}\n  model {}  (lane 0 rightmost)\n", mask_text(r, lanes_), mask_text(m, lanes_));
  };
  if (rtl.mask != model.mask) {
    throw differs("the thread mask differs", masks(rtl.mask, model.mask),
                  "rtl/compute/rp_predicate_file.v, rtl/compute/rp_warp.v", Context::Operands);
  }
  ++counts_->instructions;
  if (issue.instruction->writes_register) {
    for (uint32_t mask = model.mask; mask != 0; mask &= mask - 1) {
      const size_t lane = lowest(mask);
      if (rtl.data[lane] == model.data[lane]) continue;
      throw differs("the register result differs", lane_table(issue, lanes_, rtl.data.data(), model.data.data()),
                    result_files(*issue.instruction, configuration_), Context::Instruction);
    }
    counts_->thread_results += popcount(model.mask);
  } else if (issue.instruction->writes_predicate) {
    if (rtl.predicate != model.predicate) {
      throw differs("the predicate result differs", masks(rtl.predicate, model.predicate),
                    (rtl.predicate ^ model.predicate) & model.mask
                        ? result_files(*issue.instruction, configuration_)
                        : "rtl/compute/rp_warp.v, " + result_files(*issue.instruction, configuration_),
                    Context::Operands);
    }
    counts_->thread_results += static_cast<uint64_t>(lanes_);
  }
}

void Comparison::store(const StoreEvent& rtl, const StoreEvent& model) {
  if (rtl.address != model.address || rtl.mask != model.mask || !same_words(rtl.data, model.data, model.mask)) {
    throw Mismatch{"the words stored differ",
                   quadword_line("RTL", rtl.address, rtl.mask, rtl.data) +
                       quadword_line("model", model.address, model.mask, model.data),
                   "rtl/compute/rp_mem_alu.v, rtl/compute/rp_data_cache.v",
                   Context::Operands,
                   rtl.unit,
                   rtl.warp};
  }
  counts_->stores += popcount(model.mask);
}

void Comparison::ray_write(const RayWriteEvent& rtl, const RayWriteEvent& model) {
  bool same = rtl.mask == model.mask && rtl.word == model.word;
  for (uint32_t left = model.mask; same && left != 0; left &= left - 1) {
    const size_t lane = lowest(left);
    same = rtl.data[lane] == model.data[lane];
  }
  if (!same) {
    throw Mismatch{"the words written to ray memory differ",
                   fmt::format("  RTL wrote word {} of lanes {}, the model word {} of lanes {} (lane 0 rightmost)\n",
                               rtl.word, mask_text(rtl.mask, lanes_), model.word, mask_text(model.mask, lanes_)) +
                       lane_table(issue_(rtl.unit, rtl.warp), lanes_, rtl.data.data(), model.data.data()),
                   "rtl/compute/rp_ray_alu.v",
                   Context::Instruction,
                   rtl.unit,
                   rtl.warp};
  }
  counts_->ray_words += popcount(model.mask);
}

void Comparison::fault(const UnitOutputs& rtl, const UnitOutputs& model) const {
  if (rtl.fault.code != model.fault.code || rtl.fault.unit != model.fault.unit || rtl.fault.warp != model.fault.warp ||
      rtl.fault.pc != model.fault.pc) {
    throw Mismatch{
        "the faults differ in this cycle",
        "  RTL:   " + fault_text(rtl.fault) + "\n  model: " + fault_text(model.fault) + "\n",
        rtl.fault.unit != model.fault.unit
            ? "rtl/compute/rp_multiprocessor.v, rtl/compute/rp_compute_unit.v, rtl/compute/rp_instruction_buffer.v"
            : "rtl/compute/rp_compute_unit.v, rtl/compute/rp_instruction_buffer.v, rtl/compute/rp_multiprocessor.v",
        Context::Unit};
  }
}

// Of a side that requests nothing there is nothing to show.
void Comparison::memory_request(const UnitOutputs& rtl, const UnitOutputs& model) {
  const bool both = rtl.memory_request_valid && model.memory_request_valid;
  const MemoryRequest &r = rtl.memory_request, &m = model.memory_request;
  const bool same =
      !both ||
      (r.write == m.write && r.address == m.address &&
       (r.write ? r.id >> 5 == m.id >> 5 && r.mask == m.mask && same_words(r.data, m.data, m.mask) : r.id == m.id));
  if (rtl.memory_request_valid == model.memory_request_valid && same) return;

  std::string details = row("valid", rtl.memory_request_valid, model.memory_request_valid);
  const auto line = [&](const char* name, const std::function<std::string(const MemoryRequest&)>& text) {
    details += row(name, rtl.memory_request_valid ? text(r) : "-", model.memory_request_valid ? text(m) : "-");
  };
  const auto of_write = [&](const char* name, const std::function<std::string(const MemoryRequest&)>& text) {
    line(name, [&](const MemoryRequest& request) { return request.write ? text(request) : "-"; });
  };
  const bool writes = (rtl.memory_request_valid && r.write) || (model.memory_request_valid && m.write);
  const bool fetches = (rtl.memory_request_valid && is_fetch(r)) || (model.memory_request_valid && is_fetch(m));
  line("kind", [](const MemoryRequest& request) {
    return std::string(request.write ? "write" : is_fetch(request) ? "read of instructions" : "read of data");
  });
  line("address", [](const MemoryRequest& request) { return fmt::format("{:08x}", request.address); });
  line("id", [](const MemoryRequest& request) {
    return request.write ? fmt::format("unit {}", unit_of_id(request.id))
                         : fmt::format("{} (unit {})", request.id & 31, unit_of_id(request.id));
  });
  if (writes) {
    of_write("mask", [](const MemoryRequest& request) { return mask_text(request.mask, kBeatWords); });
    for (size_t i = 0; i < kBeatWords; ++i) {
      of_write(fmt::format("word {}", i).c_str(),
               [i](const MemoryRequest& request) { return word_text(request.data[i]); });
    }
  }
  const bool stopped = model.fault.code != FaultCode::None;  // nothing is begun after a fault
  throw Mismatch{"the memory requests differ in this cycle", details,
                 fetches && stopped ? "rtl/compute/rp_instruction_buffer.v, rtl/compute/rp_instruction_cache.v"
                 : fetches          ? kFetchModules
                                    : kMemoryModules,
                 Context::Unit};
}

void Comparison::outputs(const UnitOutputs& rtl, const UnitOutputs& model) const {
  fault(rtl, model);
  if (rtl.launch_ready != model.launch_ready || rtl.kernel_done != model.kernel_done || rtl.busy != model.busy ||
      rtl.unit_idle != model.unit_idle || rtl.idle != model.idle ||
      (rtl.launch_ready && rtl.launch_unit != model.launch_unit)) {
    throw Mismatch{"the launch outputs differ in this cycle",
                   row("launch_ready", rtl.launch_ready, model.launch_ready) +
                       row("launch_unit", rtl.launch_unit, model.launch_unit) +
                       row("kernel_done", rtl.kernel_done, model.kernel_done) + row("busy", rtl.busy, model.busy) +
                       row("unit_idle", rtl.unit_idle, model.unit_idle) + row("idle", rtl.idle, model.idle),
                   launch_files(rtl, model), Context::Unit};
  }
  memory_request(rtl, model);
  if (rtl.import_request_valid != model.import_request_valid ||
      (rtl.import_request_valid && (rtl.import_request_kind != model.import_request_kind ||
                                    rtl.import_request_unit != model.import_request_unit))) {
    throw Mismatch{"the import requests differ in this cycle",
                   row("valid", rtl.import_request_valid, model.import_request_valid) +
                       row("kind", to_underlying(rtl.import_request_kind), to_underlying(model.import_request_kind)) +
                       row("unit", rtl.import_request_unit, model.import_request_unit),
                   kImportModules, Context::Unit};
  }
  if (rtl.export_valid != model.export_valid ||
      (rtl.export_valid && (rtl.export_data != model.export_data || rtl.export_last != model.export_last ||
                            rtl.export_unit != model.export_unit))) {
    throw Mismatch{"the exported beats differ in this cycle",
                   row("valid", rtl.export_valid, model.export_valid) +
                       row("last", rtl.export_last, model.export_last) +
                       row("unit", rtl.export_unit, model.export_unit) + beat_rows(rtl.export_data, model.export_data),
                   kExportModules, Context::Unit};
  }
  if (rtl.frame_valid != model.frame_valid ||
      (rtl.frame_valid && (rtl.frame.pixel != model.frame.pixel || rtl.frame.rgb != model.frame.rgb ||
                           rtl.frame_unit != model.frame_unit))) {
    std::string details = row("valid", rtl.frame_valid, model.frame_valid) +
                          row("unit", rtl.frame_unit, model.frame_unit) +
                          row("pixel", word_text(rtl.frame.pixel), word_text(model.frame.pixel));
    static constexpr std::array<const char*, 3> kColors = {"red", "green", "blue"};
    for (size_t i = 0; i < 3; ++i)
      details += row(kColors[i], word_text(rtl.frame.rgb[i]), word_text(model.frame.rgb[i]));
    throw Mismatch{"the frame contributions differ in this cycle", details, kExportModules, Context::Unit};
  }
  if (rtl.exports != model.exports) {
    std::string details;
    for (uint32_t u = 0; u < kMostUnits; ++u) {
      if (rtl.exports[u] != model.exports[u])
        details += row(fmt::format("exports of unit {}", u).c_str(), rtl.exports[u], model.exports[u]);
    }
    throw Mismatch{"the counts of packages to be exported differ in this cycle", details, kExportCountModules,
                   Context::Unit};
  }
}

void compare_counters(const Configuration& configuration, ComputeUnit& rtl, ComputeUnit& model) {
  for (int number = 0; number < counter::kCount; ++number) {
    const uint64_t r = rtl.counter(number), m = model.counter(number);
    if (r == m) continue;
    throw Mismatch{fmt::format("performance counter {} differs", number), row("counter", r, m),
                   counter_files(rtl, model, number), Context::Unit};
  }
  const WarpCycles cycles = warp_cycles(configuration, rtl);
  // Modulo what one counts to.
  if (((cycles.sum() - cycles.busy) & ((uint64_t{1} << configuration.counter_bits) - 1)) == 0) return;
  throw Mismatch{"the warps' states do not sum up to their cycles", row("cycles", cycles.sum(), cycles.busy),
                 "rtl/compute/rp_performance_counters.v, cpp_model/machine/compute/warp_cycles.cpp", Context::Unit};
}

}  // namespace raypool::lockstep
