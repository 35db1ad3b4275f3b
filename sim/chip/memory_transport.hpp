// Accesses of the chip to a memory model at one of its sockets.
#pragma once

#include <array>
#include <cstdint>
#include <systemc>
#include <tlm>

#include "chip/chip_clock.hpp"
#include "machine/memory_port.hpp"

namespace raypool::chip {

inline constexpr uint32_t kLineBeats = raypool::MemoryPort::kLineBeats;
inline constexpr uint32_t kBeatBytes = raypool::MemoryPort::kQuadwordBytes, kLineBytes = kLineBeats * kBeatBytes;

inline constexpr unsigned kMemoryBits = 8 * kBeatBytes;  ///< width of the memory's sockets
using MemorySocket = tlm::tlm_initiator_socket<kMemoryBits>;

/// Each access is one call of b_transport, with the time from SystemC's now until `start`, to which the memory adds
/// what it takes; they return the cycle in which it is over. Throw InputError if the memory refuses, or waits.
class MemoryTransport {
 public:
  uint64_t read(tlm::tlm_blocking_transport_if<>& memory, TimeIf& clock, uint32_t address,
                std::array<Beat, kLineBeats>& data, uint64_t start);
  uint64_t write(tlm::tlm_blocking_transport_if<>& memory, TimeIf& clock, const MemoryRequest& request, uint64_t start);

 private:
  uint64_t access(tlm::tlm_blocking_transport_if<>& memory, TimeIf& clock, tlm::tlm_command command, uint32_t address,
                  void* data, uint32_t bytes, uint64_t start);

  tlm::tlm_generic_payload payload_;
  std::array<unsigned char, kBeatBytes> enable_{};  // bytes of a write
};

}  // namespace raypool::chip
