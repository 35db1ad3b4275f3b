#include "chip/fixed_latency_memory.hpp"

#include <cstring>

#include "chip/local_time.hpp"

namespace raypool::chip {

FixedLatencyMemory::FixedLatencyMemory(const sc_core::sc_module_name& name, Memory& memory,
                                       const ChipConfiguration& chip)
    : sc_module(name), memory_(memory), latency_(chip.memory_latency), rows_(chip) {
  socket.register_b_transport(this, &FixedLatencyMemory::b_transport);
}

void FixedLatencyMemory::b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
  const uint64_t row = rows_.access(static_cast<uint32_t>(payload.get_address()));
  transfer(payload, memory_);
  if (payload.is_read()) delay += sc_core::sc_time::from_value((latency_ + row) * kCyclePicoseconds);
}

void transfer(tlm::tlm_generic_payload& payload, Memory& memory) {
  const unsigned char* enable = payload.get_byte_enable_ptr();
  unsigned char* data = payload.get_data_ptr();
  const auto address = static_cast<uint32_t>(payload.get_address());
  for (uint32_t i = 0; i < payload.get_data_length(); i += 4) {
    uint32_t word = 0;
    if (payload.is_read()) {
      word = memory.load(address + i);
      std::memcpy(data + i, &word, 4);
    } else if (enable == nullptr || enable[i % payload.get_byte_enable_length()] == TLM_BYTE_ENABLED) {
      std::memcpy(&word, data + i, 4);
      memory.store(address + i, word);
    }
  }
  payload.set_response_status(tlm::TLM_OK_RESPONSE);
}

}  // namespace raypool::chip
