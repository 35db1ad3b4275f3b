// How the ports of a unit hesitate under random programs. A decision depends on seed, port and cycle alone, so that
// making one port quick leaves the decisions of all others as they were.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "enum_array.hpp"

namespace raypool {

enum class Port : uint8_t {
  Launch,          ///< the host offers the next kernel
  MemoryRequest,   ///< the memory takes a request
  MemoryLatency,   ///< how long a line takes
  MemoryResponse,  ///< the memory gives a beat, when it has one
  ImportRequest,   ///< the pool takes a request for a package
  ImportBeat,      ///< the pool gives a beat
  Export,          ///< the pool takes a beat
  Frame,           ///< the frame buffer takes a contribution
};
inline constexpr int kPorts = 8;
inline constexpr std::array<std::string_view, kPorts> kPortNames = {
    "launch",         "memory_request", "memory_latency", "memory_response",
    "import_request", "import_beat",    "export",         "frame"};

enum class StallStyle : uint8_t {
  None,    ///< never stalls; a line takes 1 cycle
  Light,   ///< stalls in one cycle of four; a line takes up to 20 cycles
  Heavy,   ///< lets through one cycle of eight; up to 200
  Bursts,  ///< open for a while, then shut for a while; lines come when it opens
  Moods,   ///< each of the above for a while
};
inline constexpr int kStallStyles = 5;
inline constexpr EnumArray<StallStyle, std::string_view, kStallStyles> kStallStyleNames = {"none", "light", "heavy",
                                                                                           "bursts", "moods"};

struct StallPlan {
  EnumArray<Port, StallStyle, kPorts> styles{};
  StallStyle& operator[](Port port) { return styles[port]; }
  StallStyle operator[](Port port) const { return styles[port]; }
};

/// 64 well mixed bits of a seed and two numbers (splitmix64's finaliser).
uint64_t mix(uint64_t seed, uint64_t a, uint64_t b);

class Stalls {
 public:
  Stalls(const StallPlan& plan, uint64_t seed) : plan_(plan), seed_(seed) {}
  /// Does the port go ahead in this cycle?
  bool open(Port port, uint64_t cycle) const;
  /// Cycles from a line's request to the first cycle in which it may be answered, at least 1.
  uint64_t latency(uint64_t cycle) const;

 private:
  StallStyle style(Port port, uint64_t cycle) const;
  StallPlan plan_;
  uint64_t seed_;
};

}  // namespace raypool
