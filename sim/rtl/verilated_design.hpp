// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// What Verilated designs have in common: clock, reset, signals by name and waveform; and reading the ports of a
// multiprocessor, which is the design or stands in it.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "machine/compute/compute_unit.hpp"
#include "verilated.h"
#include "verilated_sym_props.h"
#if VM_TRACE
#include "verilated_fst_c.h"
#endif

namespace raypool {

// A port is an integer or, beyond 64 bits, an array of 32-bit words. A field never crosses a word.
template <typename Port>
inline uint32_t bits(const Port& port, uint32_t low, uint32_t width) {
  const uint32_t mask = width >= 32 ? 0xffffffffu : (1u << width) - 1;
  if constexpr (std::is_integral_v<Port>) {
    return static_cast<uint32_t>(static_cast<uint64_t>(port) >> low) & mask;
  } else {
    return port.data()[low / 32] >> low % 32 & mask;
  }
}

template <typename Port>
inline void read_beat(const Port& port, Beat& beat) {
  for (uint32_t i = 0; i < kBeatWords; ++i) beat[i] = port.data()[i];
}

template <typename Port>
inline void write_beat(Port& port, const Beat& beat) {
  for (uint32_t i = 0; i < kBeatWords; ++i) port.data()[i] = beat[i];
}

template <typename Port>
inline void read_color(const Port& port, FrameContribution& contribution) {
  for (uint32_t i = 0; i < 3; ++i) contribution.rgb[i] = bits(port, 32 * i, 32);
}

/// A design with clock clk_i and reset rst_ni.
template <typename Top>
class VerilatedDesign {
 public:
  explicit VerilatedDesign(const std::string& name) : name_(name) {
#if VM_TRACE
    context_.traceEverOn(true);
#endif
    top_ = std::make_unique<Top>(&context_, name.c_str());
    top_->clk_i = 0;
    top_->rst_ni = 0;
    top_->eval();
  }

  ~VerilatedDesign() {
#if VM_TRACE
    if (waveform_) waveform_->close();
#endif
    top_->final();
    // Its scopes leave the thread's context, which may by now be that of another design.
    Verilated::threadContextp(&context_);
    top_.reset();
  }
  VerilatedDesign(const VerilatedDesign&) = delete;
  VerilatedDesign& operator=(const VerilatedDesign&) = delete;

  Top& top() { return *top_; }
  const Top& top() const { return *top_; }

  void clock() {
    top_->clk_i = 1;
    top_->eval();
    dump();
    top_->clk_i = 0;
    top_->eval();
    dump();
  }

  /// What depends on inputs that have been written follows them.
  void settle() { top_->eval(); }

  /// Of the instance `scope`, from the design on; of the design itself, if it is empty.
  Signal signal(const std::string& scope, const std::string& name) const {
    // Verilator's look-up is not const, though it changes nothing.
    auto* found = const_cast<VerilatedScope*>(
        context_.scopeFind((name_ + "." + name_ + (scope.empty() ? "" : "." + scope)).c_str()));
    const VerilatedVar* variable = found == nullptr ? nullptr : found->varFind(name.c_str());
    if (variable == nullptr) return {};
    return {variable->datap(), static_cast<uint32_t>(variable->packed().elements())};
  }

  void open_waveform(const std::string& path) {
#if VM_TRACE
    waveform_ = std::make_unique<VerilatedFstC>();
    top_->trace(waveform_.get(), 99);
    waveform_->open(path.c_str());
    if (!waveform_->isOpen()) throw std::runtime_error(path + ": the waveform cannot be written there");
#else
    throw std::runtime_error(
        path + ": this unit was built without waveforms; build it with scripts/verilate.sh OUTPUT_DIR --trace ...");
#endif
  }

 private:
  void dump() {
#if VM_TRACE
    if (waveform_) waveform_->dump(time_++);
#endif
  }

  std::string name_;
  VerilatedContext context_;
  std::unique_ptr<Top> top_;
#if VM_TRACE
  std::unique_ptr<VerilatedFstC> waveform_;
  uint64_t time_ = 0;
#endif
};

/// What a multiprocessor shows. `Ports` has its output ports as members.
template <typename Ports>
void read_unit_outputs(const Ports& ports, uint32_t units, UnitOutputs& out) {
  out.launch_ready = ports.launch_ready_o;
  out.launch_unit = ports.launch_unit_o;
  out.kernel_done = ports.kernel_done_o;
  out.busy = ports.busy_o;
  out.unit_idle = ports.idle_o;
  out.idle = out.unit_idle == (1u << units) - 1;
  for (uint32_t u = 0; u < units; ++u) out.exports[u] = static_cast<uint16_t>(bits(ports.exports_o, 16 * u, 16));
  out.memory_request_valid = ports.memory_request_valid_o;
  if (out.memory_request_valid) {
    MemoryRequest& request = out.memory_request;
    request.write = ports.memory_request_write_o;
    request.address = ports.memory_request_address_o;
    request.id = ports.memory_request_id_o;
    request.mask = ports.memory_request_mask_o;
    if (request.write) read_beat(ports.memory_request_data_o, request.data);
  }
  out.import_request_valid = ports.import_request_valid_o;
  out.import_request_kind = static_cast<ImportKind>(ports.import_request_kind_o);
  out.import_request_unit = ports.import_request_unit_o;
  out.export_valid = ports.export_valid_o;
  if (out.export_valid) {
    read_beat(ports.export_data_o, out.export_data);
    out.export_last = ports.export_last_o;
    out.export_unit = ports.export_unit_o;
  }
  out.frame_valid = ports.frame_valid_o;
  if (out.frame_valid) {
    out.frame.pixel = ports.frame_pixel_o;
    out.frame_unit = ports.frame_unit_o;
    read_color(ports.frame_color_o, out.frame);
  }
  out.fault = Fault{};
  if (ports.fault_valid_o)
    out.fault = {static_cast<FaultCode>(ports.fault_code_o), ports.fault_warp_o, ports.fault_pc_o, ports.fault_unit_o};
}

/// A performance counter of all units of a design with the ports counter_*.
template <typename Top>
uint64_t read_counter(Top& top, uint32_t units, int number) {
  uint64_t sum = 0;
  top.counter_select_i = static_cast<CData>(number);
  for (uint32_t u = 0; u < units; ++u) {
    top.counter_unit_i = static_cast<CData>(u);
    top.eval();
    sum += top.counter_o;
  }
  return sum;
}

}  // namespace raypool

#define RAYPOOL_EXPORT extern "C" __attribute__((visibility("default")))
