#include "machine/compute/warp_cycles.hpp"

namespace raypool {

WarpCycles warp_cycles(const Configuration& configuration, ComputeUnit& device) {
  return warp_cycles(configuration, [&](int number) { return device.counter(number); });
}

WarpCycles warp_cycles(const Configuration& configuration, const std::function<uint64_t(int)>& count) {
  WarpCycles cycles;
  cycles.busy = count(counter::kBusyCycles) * static_cast<uint64_t>(configuration.warps);
  cycles.not_launched = count(counter::kWarpsNotLaunched);
  cycles.ended = count(counter::kWarpsEnded);
  cycles.fetch = count(counter::kWarpsFetching);
  cycles.imports = count(counter::kWarpsImporting);
  cycles.exports = count(counter::kWarpsExporting);
  for (int type = 0; type < kAluTypes; ++type) {
    const uint64_t issued = count(counter::kIssued + type);
    cycles.issued += issued;
    cycles.waiting[type] = count(counter::kWaiting + type);
    // A task arrives in the cycle after it is granted, and takes as many as the pipeline has stages.
    const AluConfiguration alu = configuration.task_of(static_cast<AluType>(type));
    cycles.executing[type] = issued * (1 + static_cast<uint64_t>(alu.depth));
  }
  cycles.executing[AluType::Flt] -=
      count(counter::kFltOverlapped) * (1 + static_cast<uint64_t>(configuration.alus[AluType::Flt].depth));
  cycles.executing[AluType::Mem] = count(counter::kWarpsInMem);
  cycles.executing[AluType::Ray] = count(counter::kWarpsInRay);
  cycles.registers = cycles.issued;  // one cycle of each instruction
  return cycles;
}

}  // namespace raypool
