#include "chip/memory_port.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "isa/isa.hpp"

namespace raypool::chip {

MemoryPort::MemoryPort(const sc_core::sc_module_name& name, const ChipConfiguration& chip)
    : sc_module(name), port_(chip, {}) {
  device.bind(*this);
  turns.bind(*this);
}

// The memory takes everything at once, so nothing that comes later can change when and in which order requests are
// served: each goes to the memory as soon as it comes.
void MemoryPort::request(const MemoryRequest& request) {
  for (int i = 0; i < others.size(); ++i) others[i]->catch_up(clock->cycle());
  port_.request(clock->cycle(), request);
  const uint64_t start = serve();
  room_from_ = port_.room_from();
  if (request.write) {
    write(request, start);
  } else {
    read(request, start);
  }
}

uint64_t MemoryPort::serve() {
  const uint64_t start = port_.start();
  port_.serve(start);
  port_.taken(start + 1);
  return start;
}

// A write is posted: nobody waits for its end.
void MemoryPort::write(const MemoryRequest& request, uint64_t start) {
  for (size_t i = 0; i < kBeatBytes; ++i) {
    enable_[i] = (request.mask >> (i / 4) & 1) != 0 ? TLM_BYTE_ENABLED : TLM_BYTE_DISABLED;
  }
  payload_.set_byte_enable_ptr(enable_.data());
  payload_.set_byte_enable_length(kBeatBytes);
  Beat data = request.data;
  transport(tlm::TLM_WRITE_COMMAND, request.address, data.data(), kBeatBytes, start);
}

void MemoryPort::read(const MemoryRequest& request, uint64_t start) {
  payload_.set_byte_enable_ptr(nullptr);
  payload_.set_byte_enable_length(0);
  std::array<Beat, kLineBeats> data{};
  port_.line(transport(tlm::TLM_READ_COMMAND, request.address, data.data(), kLineBytes, start), data);
  response_due_ = port_.response_due();
}

uint64_t MemoryPort::turn(uint64_t cycle, uint32_t beats) {
  if (beats != kLineBeats && beats > 2) throw std::logic_error("a turn is for a line, or for one or two quadwords");
  port_.request(cycle, raypool::MemoryPort::TreeRequest{beats != kLineBeats, beats == 2, 0, {}});
  const uint64_t start = serve();
  if (port_.waits()) serve();
  return start;
}

// The traverser's memory keeps its data to itself.
uint64_t MemoryPort::line(uint64_t end) {
  const uint64_t last = port_.line(end, {});
  for (uint32_t i = 0; i < kLineBeats; ++i) port_.traverser_response();
  return last;
}

// Returns the cycle in which it is done.
uint64_t MemoryPort::transport(tlm::tlm_command command, uint32_t address, void* data, uint32_t bytes, uint64_t start) {
  payload_.set_command(command);
  payload_.set_address(address);
  payload_.set_data_ptr(static_cast<unsigned char*>(data));
  payload_.set_data_length(bytes);
  payload_.set_streaming_width(bytes);
  payload_.set_dmi_allowed(false);
  payload_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  sc_core::sc_time delay = clock->until(start);
  const char* what = command == tlm::TLM_READ_COMMAND ? "read" : "write";
  try {
    socket->b_transport(payload_, delay);
  } catch (const sc_core::sc_report& report) {
    throw InputError(fmt::format(
        "the memory model fails in a {} at address 0x{:x} ({}): its b_transport must add to the delay, and not wait",
        what, address, report.get_msg()));
  }
  clock->compute_quantum();  // the memory may have notified an event of its own
  if (payload_.is_response_error()) {
    throw InputError(fmt::format("the memory model answers {} to a {} of {} bytes at address 0x{:x}: it must serve it",
                                 payload_.get_response_string(), what, bytes, address));
  }
  return clock->cycle_after(delay);
}

void MemoryPort::response(MemoryResponse& response) {
  if (response_due_ != clock->cycle()) throw std::logic_error("the device was not clocked when a memory response came");
  response = port_.response();
  response_due_ = port_.response_due();
}

}  // namespace raypool::chip
