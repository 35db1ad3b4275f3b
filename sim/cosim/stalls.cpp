#include "cosim/stalls.hpp"

namespace raypool {
namespace {

constexpr uint64_t kMoodCycles = 96;    ///< for which a port of style Moods keeps one style
constexpr uint64_t kBurstCycles = 160;  ///< longest time for which a port of style Bursts is shut

}  // namespace

uint64_t mix(uint64_t seed, uint64_t a, uint64_t b) {
  uint64_t z = seed + 0x9e3779b97f4a7c15u * (a + 1) + 0xd1b54a32d192ed03u * (b + 1);
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return z ^ z >> 31;
}

StallStyle Stalls::style(Port port, uint64_t cycle) const {
  const StallStyle style = plan_[port];
  if (style != StallStyle::Moods) return style;
  return static_cast<StallStyle>(mix(seed_, 100 + static_cast<uint64_t>(port), cycle / kMoodCycles) % 4);
}

bool Stalls::open(Port port, uint64_t cycle) const {
  const uint64_t random = mix(seed_, static_cast<uint64_t>(port), cycle);
  switch (style(port, cycle)) {
    case StallStyle::None:
      return true;
    case StallStyle::Light:
      return random % 4 != 0;
    case StallStyle::Heavy:
      return random % 8 == 0;
    default:
      return mix(seed_, 200 + static_cast<uint64_t>(port), cycle / (kBurstCycles / 4)) % 4 != 0;
  }
}

uint64_t Stalls::latency(uint64_t cycle) const {
  const uint64_t random = mix(seed_, 300, cycle);
  switch (style(Port::MemoryLatency, cycle)) {
    case StallStyle::None:
      return 1;
    case StallStyle::Light:
      return 1 + random % 20;
    case StallStyle::Heavy:
      return 1 + random % 200;
    default:
      return kBurstCycles - cycle % kBurstCycles;
  }
}

}  // namespace raypool
