// Accesses at the chip's TLM-2.0 sockets, as the chip makes them: loosely timed, with exact times.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <systemc>
#include <tlm>
#include <utility>

#include "machine/chip/memory_port.hpp"

namespace raypool::chip {

inline constexpr uint32_t kLineBeats = raypool::MemoryLine::kBeats;
inline constexpr uint32_t kBeatBytes = raypool::MemoryLine::kQuadwordBytes, kLineBytes = kLineBeats * kBeatBytes;

inline constexpr unsigned kMemoryBits = 8 * kBeatBytes;  ///< width of the sockets of memories and frame buffer
using MemorySocket = tlm::tlm_initiator_socket<kMemoryBits>;

/// Each access is one call of b_transport. `delay`: from SystemC's time until it begins; the target adds what the
/// access takes. Throw InputError if the target refuses, or waits.
class MemoryTransport {
 public:
  using Target = tlm::tlm_blocking_transport_if<>;

  /// `target`: what it is, for an error.
  explicit MemoryTransport(std::string target = "memory") : target_(std::move(target)) {}

  void read(Target& memory, uint32_t address, std::array<Beat, kLineBeats>& data, sc_core::sc_time& delay);
  void write(Target& memory, const MemoryRequest& request, sc_core::sc_time& delay);
  /// All words of it.
  void write(Target& target, uint64_t address, Beat data, sc_core::sc_time& delay);

 private:
  void access(Target& target, tlm::tlm_command command, uint64_t address, void* data, uint32_t bytes,
              sc_core::sc_time& delay);

  std::string target_;
  tlm::tlm_generic_payload payload_;
  std::array<unsigned char, kBeatBytes> enable_{};  // bytes of a write
};

}  // namespace raypool::chip
