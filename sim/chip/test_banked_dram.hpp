// For tests, and for docs/machine/board.md: a memory model of one's own, to be bound to the chip's socket.
#pragma once

#include <tlm_utils/simple_target_socket.h>

#include <algorithm>
#include <array>
#include <systemc>
#include <tlm>

#include "chip/fixed_latency_memory.hpp"

namespace raypool::test {

// Rows of 2 KB go round 8 banks. A bank has one row open: an access to it takes 60 ns, to any other 140.
class BankedDram : public sc_core::sc_module {
 public:
  BankedDram(const sc_core::sc_module_name& name, Memory& memory) : sc_module(name), memory_(memory) {
    socket.register_b_transport(this, &BankedDram::b_transport);
  }

  tlm_utils::simple_target_socket<BankedDram, chip::kMemoryBits> socket{"socket"};
  uint64_t row_hits = 0, row_misses = 0;

 private:
  struct Bank {
    uint64_t row = UINT64_MAX;
    sc_core::sc_time free_at;
  };

  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
    chip::transfer(payload, memory_);
    const uint64_t row = payload.get_address() / 2048;
    Bank& bank = banks_[row % banks_.size()];
    const bool hit = bank.row == row;
    ++(hit ? row_hits : row_misses);
    bank.row = row;
    const sc_core::sc_time& now = sc_core::sc_time_stamp();  // the access begins `delay` later
    bank.free_at = std::max(now + delay, bank.free_at) + sc_core::sc_time(hit ? 60 : 140, sc_core::SC_NS);
    delay = bank.free_at - now;
  }

  Memory& memory_;
  std::array<Bank, 8> banks_;
};

}  // namespace raypool::test
