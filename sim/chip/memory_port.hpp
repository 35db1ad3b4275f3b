// The chip's one memory port: 8 GB/s, one 128-bit beat every 2 cycles, shared by the units round robin, over raypool::Memory.
//
// A line read that is accepted in cycle a by an idle port gives its four beats in cycles a+114, a+116, a+118 and a+120. Requests
// are pipelined: the next read follows 8 cycles later, the next write 2 cycles later. Data is read and written in the order in
// which requests are served, so a read sees every earlier write of its unit.
#pragma once

#include <cstdint>
#include <deque>
#include <systemc>
#include <vector>

#include "chip/chip_clock.hpp"
#include "chip/round_robin.hpp"
#include "machine/compute_unit.hpp"
#include "machine/memory.hpp"

namespace raypool::chip {

inline constexpr int kCyclesPerBeat = 2;
inline constexpr int kLineBeats = 4;
inline constexpr uint64_t kReadLatency = 120;  ///< cycles from accepted to last beat, idle port
inline constexpr size_t kMemoryQueue = 8;      ///< requests of a unit that wait to be served

class MemoryPort : public sc_core::sc_module {
 public:
  SC_HAS_PROCESS(MemoryPort);
  /// `clock` and `memory` must outlive the port.
  MemoryPort(const sc_core::sc_module_name& name, ChipClock& clock, Memory& memory, int units);

  // For unit `unit`, in the phase of the units.
  bool ready(int unit) const { return requests_[static_cast<size_t>(unit)].size() < kMemoryQueue; }
  /// Takes a request; ready() must hold.
  void request(int unit, const MemoryRequest& request);
  /// True if a beat arrives in this cycle.
  bool response(int unit, MemoryResponse& response);
  /// True if nothing of the unit is waiting or on its way.
  bool quiet(int unit) const {
    return requests_[static_cast<size_t>(unit)].empty() && responses_[static_cast<size_t>(unit)].empty();
  }

  uint64_t reads() const { return reads_; }    ///< lines
  uint64_t writes() const { return writes_; }  ///< quadwords
  uint64_t busy_cycles() const { return (reads_ * kLineBeats + writes_) * kCyclesPerBeat; }

 private:
  struct TimedResponse {
    uint64_t cycle;
    MemoryResponse response;
  };

  void serve();

  ChipClock& clock_;
  Memory& memory_;
  sc_core::sc_event work_;
  uint64_t free_at_ = 0;  // cycle in which the next request can be served
  RoundRobin turn_;
  std::vector<std::deque<MemoryRequest>> requests_;   // [unit]
  std::vector<std::deque<TimedResponse>> responses_;  // [unit]
  uint64_t reads_ = 0, writes_ = 0;
};

}  // namespace raypool::chip
