// Writes tasks with the model's results for arith_icarus.v: arith_vectors SUBNORMALS SLOW_UNIT FMA COUNT > FILE
#include <cstdio>
#include <cstdlib>

#include "alu_model.hpp"
#include "arith/test_operands.hpp"

namespace raypool {
namespace {

void write(int unit, int operation, uint32_t a, uint32_t b, uint32_t c, arith::Mode mode) {
  std::printf("%x %x %08x %08x %08x %08x\n", unit, operation, a, b, c,
              unit == 0 ? flt_model(operation, a, b, c, mode) : slw_model(operation, a, b, c, mode));
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
  const int operations = mode.fused ? 8 : 7;
  arith::OperandSource source(7);
  std::mt19937_64 random(7);
  for (int i = std::atoi(argv[4]); i > 0; --i) {
    const auto [a, b] = source.next();
    const int unit = static_cast<int>(random() % 2);
    write(unit, static_cast<int>(random() % (unit == 0 ? static_cast<unsigned>(operations) : 4)), a,
          unit == 1 && random() % 2 ? b & 0x7fffffffu : b, source.third(a, b), mode);
  }
  const std::vector<uint32_t> specials = arith::special_operands();
  for (const uint32_t a : specials) {
    for (int operation = 0; operation < operations; ++operation) {
      write(0, operation, a, specials[random() % specials.size()], specials[random() % specials.size()], mode);
    }
    for (int operation = 0; operation < 4; ++operation) write(1, operation, a, specials[random() % specials.size()], 0, mode);
  }
}
