#include "machine/compute_unit.hpp"

#include <stdexcept>

namespace raypool {

void ComputeUnit::open_waveform(const std::string& path) {
  throw std::runtime_error(
      path + ": this engine writes no waveforms; use engine rtl or lockstep with a unit built by scripts/verilate.sh --trace");
}

}  // namespace raypool
