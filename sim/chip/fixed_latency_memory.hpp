// The memory that a chip has unless another one is bound to its socket: a read is over so many cycles later, and what
// its row costs.
#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <systemc>
#include <tlm>

#include "chip/memory_rows.hpp"
#include "chip/memory_transport.hpp"
#include "machine/common/memory.hpp"

namespace raypool::chip {

class FixedLatencyMemory : public sc_core::sc_module {
 public:
  /// `memory` must outlive it.
  FixedLatencyMemory(const sc_core::sc_module_name& name, Memory& memory, const ChipConfiguration& chip);

  tlm_utils::simple_target_socket<FixedLatencyMemory, kMemoryBits> socket{"socket"};

 private:
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay);

  Memory& memory_;
  const uint64_t latency_;  // cycles from served to last beat
  MemoryRows rows_;
};

/// Moves the data of a read or write between its payload and `memory`, which is all that a memory model has to do
/// besides its time.
void transfer(tlm::tlm_generic_payload& payload, Memory& memory);

}  // namespace raypool::chip
