#include "chip/memory_transport.hpp"

#include <fmt/format.h>

#include "isa/input_error.hpp"

namespace raypool::chip {

void MemoryTransport::read(Target& memory, uint32_t address, std::array<Beat, kLineBeats>& data,
                           sc_core::sc_time& delay) {
  payload_.set_byte_enable_ptr(nullptr);
  payload_.set_byte_enable_length(0);
  access(memory, tlm::TLM_READ_COMMAND, address, data.data(), kLineBytes, delay);
}

void MemoryTransport::write(Target& memory, const MemoryRequest& request, sc_core::sc_time& delay) {
  for (size_t i = 0; i < kBeatBytes; ++i) {
    enable_[i] = (request.mask >> (i / 4) & 1) != 0 ? TLM_BYTE_ENABLED : TLM_BYTE_DISABLED;
  }
  payload_.set_byte_enable_ptr(enable_.data());
  payload_.set_byte_enable_length(kBeatBytes);
  Beat data = request.data;
  access(memory, tlm::TLM_WRITE_COMMAND, request.address, data.data(), kBeatBytes, delay);
}

void MemoryTransport::write(Target& target, uint64_t address, Beat data, sc_core::sc_time& delay) {
  payload_.set_byte_enable_ptr(nullptr);
  payload_.set_byte_enable_length(0);
  access(target, tlm::TLM_WRITE_COMMAND, address, data.data(), kBeatBytes, delay);
}

void MemoryTransport::access(Target& target, tlm::tlm_command command, uint64_t address, void* data, uint32_t bytes,
                             sc_core::sc_time& delay) {
  payload_.set_command(command);
  payload_.set_address(address);
  payload_.set_data_ptr(static_cast<unsigned char*>(data));
  payload_.set_data_length(bytes);
  payload_.set_streaming_width(bytes);
  payload_.set_dmi_allowed(false);
  payload_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  const char* what = command == tlm::TLM_READ_COMMAND ? "read" : "write";
  try {
    target.b_transport(payload_, delay);
  } catch (const sc_core::sc_report& report) {
    throw InputError(fmt::format(
        "the {} model fails in a {} at address 0x{:x} ({}): its b_transport must add to the delay, and not wait",
        target_, what, address, report.get_msg()));
  }
  if (payload_.is_response_error()) {
    throw InputError(fmt::format("the {} model answers {} to a {} of {} bytes at address 0x{:x}: it must serve it",
                                 target_, payload_.get_response_string(), what, bytes, address));
  }
}

}  // namespace raypool::chip
