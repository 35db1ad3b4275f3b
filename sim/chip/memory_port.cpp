#include "chip/memory_port.hpp"

#include <stdexcept>

namespace raypool::chip {

MemoryPort::MemoryPort(const sc_core::sc_module_name& name, ChipClock& clock, Memory& memory)
    : sc_module(name), clock_(clock), memory_(memory), work_(clock, [this] { serve(); }) {}

void MemoryPort::request(const MemoryRequest& request) {
  requests_.push_back(request);
  ++open_[unit_of_id(request.id)];
  const uint64_t now = clock_.cycle();
  work_.ask(free_at_ > now ? free_at_ - now : 0);
}

bool MemoryPort::next_response(MemoryResponse& response) {
  if (responses_.front().cycle > clock_.cycle()) return false;
  if (responses_.front().cycle < clock_.cycle()) throw std::logic_error("the device was not clocked when a memory response came");
  response = responses_.front().response;
  responses_.pop_front();
  if (response.beat == kLineBeats - 1) --open_[unit_of_id(response.id)];
  return true;
}

void MemoryPort::serve() {
  if (requests_.empty()) return;
  const MemoryRequest request = requests_.front();
  requests_.pop_front();
  const uint64_t now = clock_.cycle();
  if (request.write) {
    ++writes_;
    --open_[unit_of_id(request.id)];
    for (uint32_t i = 0; i < kBeatWords; ++i) {
      if ((request.mask >> i & 1) != 0) memory_.store(request.address + 4 * i, request.data[i]);
    }
    free_at_ = now + kCyclesPerBeat;
  } else {
    ++reads_;
    const uint64_t first = now + kReadLatency - (kLineBeats - 1) * kCyclesPerBeat;
    for (uint32_t beat = 0; beat < kLineBeats; ++beat) {
      MemoryResponse response{request.id, static_cast<uint8_t>(beat), {}};
      for (uint32_t i = 0; i < kBeatWords; ++i) response.data[i] = memory_.load(request.address + 16 * beat + 4 * i);
      responses_.push_back({first + beat * kCyclesPerBeat, response});
    }
    free_at_ = now + kLineBeats * kCyclesPerBeat;
  }
  if (!requests_.empty()) work_.ask(free_at_ - now);
}

}  // namespace raypool::chip
