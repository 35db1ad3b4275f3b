// The chip's one memory port: 8 GB/s, one 128-bit beat every 2 cycles, over raypool::Memory.
//
// A line read that is accepted in cycle a by an idle port gives its four beats in cycles a+114, a+116, a+118 and a+120. Requests
// are pipelined: the next read follows 8 cycles later, the next write 2 cycles later. Data is read and written in the order in
// which requests come, so a read sees every earlier write.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <systemc>

#include "chip/chip_clock.hpp"
#include "machine/compute_unit.hpp"
#include "machine/memory.hpp"

namespace raypool::chip {

inline constexpr int kCyclesPerBeat = 2;
inline constexpr int kLineBeats = 4;
inline constexpr uint64_t kReadLatency = 120;  ///< cycles from accepted to last beat, idle port
inline constexpr size_t kMemoryQueue = 8;      ///< requests that wait to be served

class MemoryPort : public sc_core::sc_module {
 public:
  /// `clock` and `memory` must outlive the port.
  MemoryPort(const sc_core::sc_module_name& name, ChipClock& clock, Memory& memory);

  // For the device, in the phase of the units.
  bool ready() const { return requests_.size() < kMemoryQueue; }
  /// Takes a request; ready() must hold.
  void request(const MemoryRequest& request);
  /// True if a beat arrives in this cycle.
  bool response(MemoryResponse& response) { return !responses_.empty() && next_response(response); }
  /// Cycle of the next beat; UINT64_MAX: none is on its way.
  uint64_t response_due() const { return responses_.empty() ? UINT64_MAX : responses_.front().cycle; }
  /// True if nothing of compute unit `unit` is waiting or on its way.
  bool quiet(uint32_t unit) const { return open_[unit] == 0; }

  uint64_t reads() const { return reads_; }    ///< lines
  uint64_t writes() const { return writes_; }  ///< quadwords
  uint64_t busy_cycles() const { return (reads_ * kLineBeats + writes_) * kCyclesPerBeat; }

 private:
  struct TimedResponse {
    uint64_t cycle;
    MemoryResponse response;
  };

  bool next_response(MemoryResponse& response);
  void serve();

  ChipClock& clock_;
  Memory& memory_;
  PortWork work_;
  uint64_t free_at_ = 0;  // cycle in which the next request can be served
  std::deque<MemoryRequest> requests_;
  std::deque<TimedResponse> responses_;
  std::array<uint32_t, kMostUnits> open_{};  // [unit] requests that wait, and reads of which a beat is to come
  uint64_t reads_ = 0, writes_ = 0;
};

}  // namespace raypool::chip
