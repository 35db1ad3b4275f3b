#include "chip/memory_port.hpp"

#include <stdexcept>

namespace raypool::chip {

MemoryPort::MemoryPort(const sc_core::sc_module_name& name, ChipClock& clock, Memory& memory, int units)
    : sc_module(name),
      clock_(clock),
      memory_(memory),
      turn_(units),
      requests_(static_cast<size_t>(units)),
      responses_(static_cast<size_t>(units)) {
  SC_METHOD(serve);
  sensitive << work_;
  dont_initialize();
}

void MemoryPort::request(int unit, const MemoryRequest& request) {
  requests_[static_cast<size_t>(unit)].push_back(request);
  const uint64_t now = clock_.cycle();
  clock_.notify(work_, Phase::Ports, free_at_ > now ? free_at_ - now : 0);
}

bool MemoryPort::response(int unit, MemoryResponse& response) {
  auto& waiting = responses_[static_cast<size_t>(unit)];
  if (waiting.empty() || waiting.front().cycle > clock_.cycle()) return false;
  if (waiting.front().cycle < clock_.cycle()) throw std::logic_error("a unit was not clocked when a memory response came");
  response = waiting.front().response;
  waiting.pop_front();
  return true;
}

void MemoryPort::serve() {
  clock_.guard([&] {
    const int unit = turn_.next([&](int u) { return !requests_[static_cast<size_t>(u)].empty(); });
    if (unit < 0) return;
    auto& queue = requests_[static_cast<size_t>(unit)];
    const MemoryRequest request = queue.front();
    queue.pop_front();
    const uint64_t now = clock_.cycle();
    if (request.write) {
      ++writes_;
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
        responses_[static_cast<size_t>(unit)].push_back({first + beat * kCyclesPerBeat, response});
      }
      free_at_ = now + kLineBeats * kCyclesPerBeat;
    }
    clock_.notify(work_, Phase::Ports, free_at_ - now);
  });
}

}  // namespace raypool::chip
