// The board of a chip in SystemC (chip_systemc.hpp): frame buffer and host, and their assembly with the chip and its
// memories. Any of them can be replaced by a module of the user's own with the same sockets.
#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include <optional>
#include <string>
#include <systemc>
#include <tlm>

#include "chip/chip_systemc.hpp"
#include "chip/fixed_latency_memory.hpp"
#include "chip/simulation.hpp"

namespace raypool {

namespace chip {

/// Hands contributions to a FrameSink, one a cycle.
class FrameBufferModule : public sc_core::sc_module {
 public:
  /// `sink` must outlive it.
  FrameBufferModule(const sc_core::sc_module_name& name, FrameSink& sink);

  tlm_utils::simple_target_socket<FrameBufferModule, kMemoryBits> socket{"socket"};

 private:
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay);

  FrameSink& sink_;
};

/// The contribution of a write at the chip's socket `frame`.
FrameContribution contribution_of(const tlm::tlm_generic_payload& payload);

/// Writes the setup of a frame, starts it, and stops the simulation when it is done.
class HostModule : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(HostModule);
  HostModule(const sc_core::sc_module_name& name, const FrameSetup& setup, FrameBegin begin = FrameBegin::Reset);

  tlm_utils::simple_initiator_socket<HostModule, kHostBits> socket{"socket"};
  sc_core::sc_in<bool> done{"done"};

  /// After the simulation: throws InputError if the chip has refused an access.
  void rethrow() const { errors_.rethrow(); }

 private:
  void start_of_simulation() override { start_.notify(1, sc_core::SC_NS); }
  void start();
  void stop() { sc_core::sc_stop(); }

  const FrameSetup setup_;
  const FrameBegin begin_;
  sc_core::sc_event start_;
  ProcessErrors errors_;
};

/// Writes words to consecutive registers at the chip's socket `host`. Throws InputError if it refuses.
void write_registers(tlm::tlm_blocking_transport_if<>& chip, uint32_t address, const uint32_t* words, uint32_t count);
uint32_t read_register(tlm::tlm_blocking_transport_if<>& chip, uint32_t address);

/// Chip, memories, frame buffer and host, bound to one another, in a simulation of their own.
class SystemcBoard {
 public:
  /// As run_board().
  SystemcBoard(const ChipOptions& options, ChipDevice& device, FrameBegin begin = FrameBegin::Reset);

  /// Once. Throws as run_board() does.
  ChipResult draw();

 private:
  Simulation simulation_;
  ChipModule chip_;
  FixedLatencyMemory memory_;
  std::optional<FixedLatencyMemory> tree_;
  FrameBufferModule frame_;
  HostModule host_;
  sc_core::sc_signal<bool> done_{"done"};
};

}  // namespace chip

/// run_board() as an assembly of SystemC modules, in the same cycles. One run at a time in a process.
ChipResult run_chip(const ChipOptions& options, ChipDevice& chip, FrameBegin begin = FrameBegin::Reset);

/// The modules of that board, with their ports and what each is bound to: a line each.
std::string chip_modules(const ChipOptions& options, ChipDevice& chip);

}  // namespace raypool
