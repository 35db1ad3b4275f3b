#include "machine/chip_device.hpp"

#include <stdexcept>

namespace raypool {

void ChipDevice::open_waveform(const std::string& path) {
  throw std::runtime_error(path + ": this engine has no waveforms");
}

}  // namespace raypool
