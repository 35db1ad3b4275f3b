// The chip's one memory port in front of the memory at its TLM-2.0 socket: as the thesis has it 8 GB/s, one 128-bit
// beat every 2 cycles.
//
// Requests are served in the order in which they come: a read keeps the port for 4 beats, a write for one. Each is one
// call of b_transport, whose time begins when it is served; a read ends when its last beat is there. So with the chip's
// own memory (fixed_latency_memory.hpp) a line read that is accepted in cycle a by an idle port gives its beats in
// a+114 .. a+120. Others (MemoryTurnsIf) take turns between them, and have a memory of their own behind the port.
#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <array>
#include <cstdint>
#include <deque>
#include <systemc>
#include <tlm>
#include <vector>

#include "chip/chip_clock.hpp"
#include "chip/interfaces.hpp"
#include "config/configuration.hpp"

namespace raypool::chip {

inline constexpr uint32_t kLineBeats = 4;
inline constexpr uint32_t kBeatBytes = 16, kLineBytes = kLineBeats * kBeatBytes;

inline constexpr unsigned kMemoryBits = 8 * kBeatBytes;  ///< width of the memory's sockets
using MemorySocket = tlm::tlm_initiator_socket<kMemoryBits>;

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
  bool quiet(uint32_t unit) const override { return reading_[unit] == 0 && clock->cycle() >= written_[unit]; }

  uint64_t turn(uint64_t cycle, uint32_t beats) override;
  uint64_t line(uint64_t start, uint64_t end) override;

  uint64_t reads() const { return reads_; }    ///< lines, of the device
  uint64_t writes() const { return writes_; }  ///< quadwords, of the device
  uint64_t busy_cycles() const { return (reads_ * kLineBeats + writes_ + other_beats_) * cycles_per_beat_; }

 private:
  struct Line {
    uint64_t due;  // next beat
    uint8_t id, beat;
    std::array<Beat, kLineBeats> data;
  };

  void read(const MemoryRequest& request, uint64_t start);
  void write(const MemoryRequest& request, uint64_t start);
  uint64_t transport(tlm::tlm_command command, uint32_t address, void* data, uint32_t bytes, uint64_t start);

  uint64_t cycles_per_beat_;
  tlm::tlm_generic_payload payload_;
  uint64_t free_from_ = 0;                 // the next request can be served
  std::vector<uint64_t> place_free_from_;  // a ring: of the latest requests that may wait, oldest at `place_`
  size_t place_ = 0;
  uint64_t last_beat_ = 0;
  std::deque<Line> lines_;                          // on their way, in the order of their requests
  std::array<uint32_t, kMostUnits> reading_{};      // [unit] lines of which a beat is to come
  std::array<uint64_t, kMostUnits> written_{};      // [unit] from then on no write waits
  std::array<unsigned char, kBeatBytes> enable_{};  // bytes of a write
  uint64_t reads_ = 0, writes_ = 0, other_beats_ = 0;
};

}  // namespace raypool::chip
