// The memory that a chip has unless another one is bound to its socket: whatever it is asked, a read is over so many
// cycles later.
#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <systemc>
#include <tlm>

#include "chip/memory_port.hpp"
#include "machine/memory.hpp"

namespace raypool::chip {

class FixedLatencyMemory : public sc_core::sc_module {
 public:
  /// `memory` must outlive it. `latency`: cycles from served to last beat.
  FixedLatencyMemory(const sc_core::sc_module_name& name, Memory& memory, uint64_t latency);

  tlm_utils::simple_target_socket<FixedLatencyMemory, kMemoryBits> socket{"socket"};

 private:
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay);

  Memory& memory_;
  const sc_core::sc_time latency_;
};

/// Moves the data of a read or write between its payload and `memory`, which is all that a memory model has to do
/// besides its time.
void transfer(tlm::tlm_generic_payload& payload, Memory& memory);

}  // namespace raypool::chip
