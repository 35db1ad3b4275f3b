// The chip's one memory port (cpp_model/machine/memory_port.hpp) in front of the memory at its TLM-2.0 socket: as the
// thesis has it 8 GB/s, one 128-bit beat every 2 cycles.
//
// Each request is one call of b_transport, whose time begins when it is served; a read ends when its last beat is
// there. So with the chip's own memory (fixed_latency_memory.hpp) a line read that is accepted in cycle a by an idle
// port gives its beats in a+114 .. a+120. The traverser (MemoryTurnsIf) has a memory of its own behind the port.
#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <array>
#include <cstdint>
#include <systemc>
#include <tlm>

#include "chip/chip_clock.hpp"
#include "chip/interfaces.hpp"
#include "chip/memory_transport.hpp"
#include "config/configuration.hpp"
#include "machine/memory_port.hpp"

namespace raypool::chip {

class MemoryPort : public sc_core::sc_module, public MemoryIf, public MemoryTurnsIf {
 public:
  MemoryPort(const sc_core::sc_module_name& name, const ChipConfiguration& chip);

  sc_core::sc_port<TimeIf> clock{"clock"};
  sc_core::sc_port<MemoryUserIf, 0, sc_core::SC_ZERO_OR_MORE_BOUND> others{"others"};
  sc_core::sc_export<MemoryIf> device{"device"};
  sc_core::sc_export<MemoryTurnsIf> turns{"turns"};
  tlm_utils::simple_initiator_socket<MemoryPort, kMemoryBits> socket{"socket"};

  void request(const MemoryRequest& request) override;
  void response(MemoryResponse& response) override;
  bool quiet(uint32_t unit) const override { return port_.quiet(clock->cycle(), unit); }

  uint64_t turn(uint64_t cycle, uint32_t beats) override;
  uint64_t line(uint64_t end) override;

  /// What is on its way, for an error.
  std::string describe() const;
  uint64_t reads() const { return port_.reads(); }    ///< lines, of the device
  uint64_t writes() const { return port_.writes(); }  ///< quadwords, of the device
  uint64_t busy_cycles() const { return port_.busy_cycles(); }

 private:
  uint64_t serve();
  void read(const MemoryRequest& request, uint64_t start);

  raypool::MemoryPort port_;
  MemoryTransport transport_;
};

}  // namespace raypool::chip
