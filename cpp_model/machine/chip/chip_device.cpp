// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
#include "machine/chip/chip_device.hpp"

#include <stdexcept>

namespace raypool {

void ChipDevice::open_waveform(const std::string& path) {
  throw std::runtime_error(path + ": this engine has no waveforms");
}

std::optional<TraverserWork> ChipDevice::traverser_work() const { return {}; }

uint64_t ChipDevice::run(const ChipInputs& inputs, uint64_t /*cycles*/) {
  clock(inputs);
  return 1;
}

void ChipDevice::settle(const ChipInputs& /*inputs*/) {}

void ChipDevice::check_next(const FrameSetup& before, const FrameSetup& setup, const ChipOutputs& outputs) {
  if (!outputs.ready) throw std::logic_error("a frame is started while something of another one is left in the chip");
  if (setup.program_length != before.program_length || setup.memory_limit != before.memory_limit)
    throw std::logic_error("another program length or memory limit needs a reset of the chip");
}

Signal ChipDevice::signal(const std::string& /*scope*/, const std::string& /*name*/) const { return {}; }

}  // namespace raypool
