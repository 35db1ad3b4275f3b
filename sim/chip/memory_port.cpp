#include "chip/memory_port.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "chip/progress_watch.hpp"
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
    transport_.write(*socket[0], *clock[0], request, start);  // posted: nobody waits for its end
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

void MemoryPort::read(const MemoryRequest& request, uint64_t start) {
  std::array<Beat, kLineBeats> data{};
  port_.line(transport_.read(*socket[0], *clock[0], request.address, data, start), data);
  response_due_ = port_.response_due();
}

std::string MemoryPort::describe() const {
  if (response_due_ == kNever) return "memory port: nothing is on its way";
  if (response_due_ >= kFarAway) return "memory port: the device waits for a line that the memory never gives";
  return fmt::format("memory port: the device waits for a line that the memory gives in cycle {}", response_due_);
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

void MemoryPort::response(MemoryResponse& response) {
  if (response_due_ != clock->cycle()) throw std::logic_error("the device was not clocked when a memory response came");
  response = port_.response();
  response_due_ = port_.response_due();
}

}  // namespace raypool::chip
