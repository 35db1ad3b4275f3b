// A kernel of one's own on a chip of one's own: y[i] = sqrt(x[i]) for 256 elements, and how the
// time grows with the memory's latency.
//   own_chip [UNIT_LIBRARY]    with the Verilated unit of 4w4c: hardware and model
//                              side by side, compared in every cycle
#include <cmath>
#include <cstdio>
#include <raypool/bits.hpp>
#include <raypool/kernel/kernel.hpp>
#include <raypool/lockstep/lockstep_unit.hpp>
#include <raypool/lockstep/rtl_loader.hpp>
#include <raypool/machine/compute/cycle_unit.hpp>

#include "chip.hpp"

constexpr uint32_t kElements = 256, kX = 4096, kY = 8192;

template <typename K>
void roots(K& k) {
  const typename K::Int offset = (k.block() * k.threads() + k.thread()) << 2;
  k.store(k.int_argument(1) + offset, 0, sqrt(k.load_float(k.int_argument(0) + offset)));
}

int run(const char* library, uint64_t latency) {
  const raypool::Configuration configuration = raypool::load_configuration("4w4c");
  raypool::Program program;
  raypool::kernel::add_kernel(program, "roots", [](auto& k) { roots(k); });

  raypool::Memory memory(16384);
  for (uint32_t i = 0; i < program.code.size(); ++i) {
    memory.store(8 * i, static_cast<uint32_t>(program.code[i]));
    memory.store(8 * i + 4, static_cast<uint32_t>(program.code[i] >> 32));
  }
  for (uint32_t i = 0; i < kElements; ++i) memory.store(kX + 4 * i, raypool::as_bits(static_cast<float>(i)));

  std::unique_ptr<raypool::ComputeUnit> unit = std::make_unique<raypool::CycleUnit>(configuration, memory);
  if (library != nullptr)
    unit = raypool::make_lockstep_unit(configuration, raypool::load_rtl_unit(library, configuration), memory);
  unit->reset(static_cast<uint32_t>(program.code.size()), memory.size());
  unit->set_argument(0, kX);
  unit->set_argument(1, kY);
  const uint32_t threads = configuration.contents();
  const uint64_t cycles = Chip(*unit, memory, latency).run(program.entries.at("roots"), threads, kElements / threads);

  int wrong = 0;
  for (uint32_t i = 0; i < kElements; ++i)
    wrong += memory.load(kY + 4 * i) != raypool::as_bits(std::sqrt(static_cast<float>(i)));
  std::printf("latency %3d: %u roots, %d wrong, %d cycles\n", static_cast<int>(latency), kElements, wrong,
              static_cast<int>(cycles));
  return wrong;
}

int main(int argc, char** argv) {
  int wrong = 0;
  for (const uint64_t latency : {1, 20, 200}) wrong += run(argc > 1 ? argv[1] : nullptr, latency);
  return wrong == 0 ? 0 : 1;
}
