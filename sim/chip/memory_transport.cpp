#include "chip/memory_transport.hpp"

#include <fmt/format.h>

#include "isa/input_error.hpp"

namespace raypool::chip {

uint64_t MemoryTransport::read(tlm::tlm_blocking_transport_if<>& memory, TimeIf& clock, uint32_t address,
                               std::array<Beat, kLineBeats>& data, uint64_t start) {
  payload_.set_byte_enable_ptr(nullptr);
  payload_.set_byte_enable_length(0);
  return access(memory, clock, tlm::TLM_READ_COMMAND, address, data.data(), kLineBytes, start);
}

uint64_t MemoryTransport::write(tlm::tlm_blocking_transport_if<>& memory, TimeIf& clock, const MemoryRequest& request,
                                uint64_t start) {
  for (size_t i = 0; i < kBeatBytes; ++i) {
    enable_[i] = (request.mask >> (i / 4) & 1) != 0 ? TLM_BYTE_ENABLED : TLM_BYTE_DISABLED;
  }
  payload_.set_byte_enable_ptr(enable_.data());
  payload_.set_byte_enable_length(kBeatBytes);
  Beat data = request.data;
  return access(memory, clock, tlm::TLM_WRITE_COMMAND, request.address, data.data(), kBeatBytes, start);
}

uint64_t MemoryTransport::access(tlm::tlm_blocking_transport_if<>& memory, TimeIf& clock, tlm::tlm_command command,
                                 uint32_t address, void* data, uint32_t bytes, uint64_t start) {
  payload_.set_command(command);
  payload_.set_address(address);
  payload_.set_data_ptr(static_cast<unsigned char*>(data));
  payload_.set_data_length(bytes);
  payload_.set_streaming_width(bytes);
  payload_.set_dmi_allowed(false);
  payload_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  sc_core::sc_time delay = clock.until(start);
  const char* what = command == tlm::TLM_READ_COMMAND ? "read" : "write";
  try {
    memory.b_transport(payload_, delay);
  } catch (const sc_core::sc_report& report) {
    throw InputError(fmt::format(
        "the memory model fails in a {} at address 0x{:x} ({}): its b_transport must add to the delay, and not wait",
        what, address, report.get_msg()));
  }
  clock.compute_quantum();  // the memory may have notified an event of its own
  if (payload_.is_response_error()) {
    throw InputError(fmt::format("the memory model answers {} to a {} of {} bytes at address 0x{:x}: it must serve it",
                                 payload_.get_response_string(), what, bytes, address));
  }
  return clock.cycle_after(delay);
}

}  // namespace raypool::chip
