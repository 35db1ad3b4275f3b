// What a host gave a device in every cycle of a run, so that other engines can be clocked
// through the same run without the host.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "isa/isa.hpp"
#include "machine/common/memory.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool::bench {

struct PortRecording {
  /// Some cycles with the same readies; launch, response and beat are of the first.
  struct Span {
    uint32_t cycles;
    uint8_t readies;  ///< memory request, import request, export, frame: bits 0 .. 3
    bool launch, response, beat;
  };

  Memory memory;  ///< at the reset
  uint32_t program_length = 0, memory_limit = 0;
  std::array<uint32_t, kArguments> arguments{};
  std::vector<Span> spans;
  std::vector<LaunchCommand> launches;
  std::vector<MemoryResponse> responses;
  std::vector<Beat> beats;
  uint64_t cycles = 0;
};

/// `device`, with its inputs written to `recording`; `memory` is the host's. Both must outlive it.
std::unique_ptr<ComputeUnit> record_ports(std::unique_ptr<ComputeUnit> device, const Memory& memory,
                                          PortRecording& recording);

/// Resets the device and clocks it through the recording. `memory`, which the device was
/// made with, must equal the recording's.
void replay(ComputeUnit& device, const PortRecording& recording);

}  // namespace raypool::bench
