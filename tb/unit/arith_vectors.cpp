// Writes tasks with the model's results for arith_icarus.v: arith_vectors SUBNORMALS SLOW_UNIT FMA COUNT > FILE
#include <cstdio>
#include <cstdlib>

#include "alu_model.hpp"
#include "arith/test_operands.hpp"

namespace raypool {
namespace {

void write(int unit, int operation, uint32_t a, uint32_t b, uint32_t c, arith::Mode mode) {
  constexpr ModelFunction kModels[] = {flt_model, slw_model, brh_model};
  std::printf("%x %x %08x %08x %08x %08x\n", unit, operation, a, b, c, kModels[unit](operation, a, b, c, mode));
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
  using namespace raypool;
  if (argc != 5) {
    std::fputs("usage: arith_vectors SUBNORMALS SLOW_UNIT FMA COUNT > FILE\n", stderr);
    return 1;
  }
  const arith::Mode mode{static_cast<Subnormals>(std::atoi(argv[1])), static_cast<SlowUnit>(std::atoi(argv[2])),
                         std::atoi(argv[3]) != 0};
  const unsigned operations[] = {mode.fused ? 8u : 7u, 4, 20};
  arith::OperandSource source(7);
  std::mt19937_64 random(7);
  for (int i = std::atoi(argv[4]); i > 0; --i) {
    const auto [a, b] = source.next();
    const int unit = static_cast<int>(random() % 3);
    write(unit, static_cast<int>(random() % operations[unit]), a, unit == 1 && random() % 2 ? b & 0x7fffffffu : b,
          source.third(a, b), mode);
  }
  const std::vector<uint32_t> specials = arith::special_operands();
  for (const uint32_t a : specials) {
    for (int unit = 0; unit < 3; ++unit) {
      for (unsigned operation = 0; operation < operations[unit]; ++operation) {
        write(unit, static_cast<int>(operation), a, specials[random() % specials.size()], specials[random() % specials.size()],
              mode);
      }
    }
  }
}
