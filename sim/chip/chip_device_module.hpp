// The chip as one piece as a SystemC module, to be bound to memories: run_board (board.hpp) with sockets, around the
// C++ model of the chip or the Verilated Verilog. docs/chip.md has an example.
#pragma once

#include <optional>
#include <systemc>

#include "chip/board.hpp"
#include "chip/chip_clock.hpp"
#include "chip/memory_transport.hpp"

namespace raypool::chip {

/// Draws one frame, in one simulation (simulation.hpp) of its own. An event of SystemC a cycle: the memories, and
/// whoever shares them, keep the chip's time.
class ChipDeviceModule : public sc_core::sc_module, private LineStore {
 public:
  SC_HAS_PROCESS(ChipDeviceModule);
  /// Throws as run_board does. What the options point to, and `chip`, must outlive the module; `options.memory` and
  /// `options.tree` say how large the memories are and what is in them, which those that are bound must hold too.
  /// An answer may take some hundred times `chip.memory.latency` of the configuration (AnswerWatch).
  ChipDeviceModule(const sc_core::sc_module_name& name, const ChipOptions& options, ChipDevice& chip);

  MemorySocket memory{"memory"};  ///< that of the units
  /// That of a traverser inside; of a chip without one it stays unbound.
  tlm::tlm_initiator_socket<kMemoryBits, tlm::tlm_base_protocol_types, 1, sc_core::SC_ZERO_OR_MORE_BOUND> tree{"tree"};

  /// Draws. Throws as run_board does, and InputError if a memory refuses an access.
  ChipResult draw();

 private:
  void start_of_simulation() override;
  void run();
  uint64_t read(bool traverser, uint32_t address, Line& line) override;
  void write(bool traverser, const MemoryRequest& request) override;
  tlm::tlm_blocking_transport_if<>& of(bool traverser);

  /// Takes what a memory that has its own time does not use: nobody answers, as nobody asks.
  struct Nobody : tlm::tlm_bw_transport_if<> {
    tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload&, tlm::tlm_phase&, sc_core::sc_time&) override {
      return tlm::TLM_COMPLETED;
    }
    void invalidate_direct_mem_ptr(sc_dt::uint64, sc_dt::uint64) override {}
  };

  Nobody nobody_;
  const ChipOptions options_;
  ChipClock clock_{"clock"};
  sc_core::sc_event next_cycle_;
  MemoryTransport transport_;
  Board board_;
};

}  // namespace raypool::chip
