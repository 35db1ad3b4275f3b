#include "chip/memory_port.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "isa/isa.hpp"

namespace raypool::chip {

MemoryPort::MemoryPort(const sc_core::sc_module_name& name, const ChipConfiguration& chip)
    : sc_module(name), cycles_per_beat_(chip.memory_cycles_per_beat), place_free_from_(chip.memory_queue) {
  device.bind(*this);
  turns.bind(*this);
}

// Nothing that comes later can change when and in which order requests are served: so each goes to the memory at once.
void MemoryPort::request(const MemoryRequest& request) {
  for (int i = 0; i < others.size(); ++i) others[i]->catch_up(clock->cycle());
  const uint64_t start = std::max(free_from_, clock->cycle());
  place_free_from_[place_] = start + 1;
  place_ = (place_ + 1) % place_free_from_.size();
  room_from_ = place_free_from_[place_];
  if (request.write) {
    write(request, start);
  } else {
    read(request, start);
  }
}

// A write is posted: nobody waits for its end.
void MemoryPort::write(const MemoryRequest& request, uint64_t start) {
  ++writes_;
  free_from_ = start + cycles_per_beat_;
  written_[unit_of_id(request.id)] = start + 1;
  for (size_t i = 0; i < kBeatBytes; ++i) {
    enable_[i] = (request.mask >> (i / 4) & 1) != 0 ? TLM_BYTE_ENABLED : TLM_BYTE_DISABLED;
  }
  payload_.set_byte_enable_ptr(enable_.data());
  payload_.set_byte_enable_length(kBeatBytes);
  Beat data = request.data;
  transport(tlm::TLM_WRITE_COMMAND, request.address, data.data(), kBeatBytes, start);
}

void MemoryPort::read(const MemoryRequest& request, uint64_t start) {
  ++reads_;
  free_from_ = start + kLineBeats * cycles_per_beat_;
  ++reading_[unit_of_id(request.id)];
  payload_.set_byte_enable_ptr(nullptr);
  payload_.set_byte_enable_length(0);
  Line line{0, request.id, 0, {}};
  const uint64_t end = transport(tlm::TLM_READ_COMMAND, request.address, line.data.data(), kLineBytes, start);
  line.due = this->line(start, end) - (kLineBeats - 1) * cycles_per_beat_;
  lines_.push_back(line);
  response_due_ = lines_.front().due;
}

uint64_t MemoryPort::turn(uint64_t cycle, uint32_t beats) {
  const uint64_t start = std::max(free_from_, cycle);
  free_from_ = start + beats * cycles_per_beat_;
  other_beats_ += beats;
  return start;
}

// Beats are apart, and lines in order, however fast the memory is.
uint64_t MemoryPort::line(uint64_t start, uint64_t end) {
  last_beat_ = std::max(end, std::max(last_beat_, start) + kLineBeats * cycles_per_beat_);
  return last_beat_;
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
  Line& line = lines_.front();
  if (line.due != clock->cycle()) throw std::logic_error("the device was not clocked when a memory response came");
  response = {line.id, line.beat, line.data[line.beat]};
  line.due += cycles_per_beat_;
  if (++line.beat == kLineBeats) {
    --reading_[unit_of_id(line.id)];
    lines_.pop_front();
  }
  response_due_ = lines_.empty() ? kNever : lines_.front().due;
}

}  // namespace raypool::chip
