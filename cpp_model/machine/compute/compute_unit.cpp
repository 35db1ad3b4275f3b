// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
#include "machine/compute/compute_unit.hpp"

#include <stdexcept>

namespace raypool {

std::vector<Fault> ComputeUnit::faults() const {
  const Fault& fault = outputs().fault;
  return fault.code == FaultCode::None ? std::vector<Fault>() : std::vector<Fault>{fault};
}

Signal ComputeUnit::signal(const std::string& /*scope*/, const std::string& /*name*/) const { return {}; }

void ComputeUnit::open_waveform(const std::string& path) {
  throw std::runtime_error(
      path +
      ": this engine writes no waveforms; use engine rtl or lockstep with a unit built by scripts/verilate.sh --trace");
}

}  // namespace raypool
