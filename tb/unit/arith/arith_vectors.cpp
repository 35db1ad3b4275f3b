// Writes tasks with the model's results for arith_icarus.v: arith_vectors SUBNORMALS SLOW_UNIT FMA SIGNIFICAND COUNT >
// FILE
#include <cstdio>
#include <cstdlib>

#include "arith/test_operands.hpp"
#include "unit/compute/alu_model.hpp"

namespace raypool {
namespace {

/// `alu`: as arith_icarus.v numbers them.
void write(size_t alu, Opcode opcode, uint32_t a, uint32_t b, uint32_t c, arith::Mode mode) {
  constexpr ModelFunction kModels[] = {flt_model, slw_model, brh_model};
  std::printf("%zx %x %08x %08x %08x %08x\n", alu, operation_of(opcode), a, b, c, kModels[alu](opcode, a, b, c, mode));
}

}  // namespace
}  // namespace raypool

int main(int argc, char** argv) {
  using namespace raypool;
  if (argc != 6) {
    std::fputs("usage: arith_vectors SUBNORMALS SLOW_UNIT FMA SIGNIFICAND COUNT > FILE\n", stderr);
    return 1;
  }
  const arith::Mode mode{static_cast<Subnormals>(std::atoi(argv[1])), static_cast<SlowUnit>(std::atoi(argv[2])),
                         std::atoi(argv[3]) != 0, static_cast<uint32_t>(std::atoi(argv[4]))};
  std::vector<Opcode> opcodes[] = {opcodes_of(AluType::Flt), opcodes_of(AluType::Slw), opcodes_of(AluType::Brh)};
  if (!mode.fused) opcodes[0].pop_back();  // ffma
  arith::OperandSource source(7, mode.significand);
  std::mt19937_64 random(7);
  for (int i = std::atoi(argv[5]); i > 0; --i) {
    const auto [a, b] = source.next();
    const size_t alu = random() % 3;
    write(alu, opcodes[alu][random() % opcodes[alu].size()], a, alu == 1 && random() % 2 ? b & 0x7fffffffu : b,
          source.third(a, b), mode);
  }
  const std::vector<uint32_t> specials = arith::special_operands(mode.significand);
  for (const uint32_t a : specials) {
    for (size_t alu = 0; alu < 3; ++alu) {
      for (const Opcode opcode : opcodes[alu])
        write(alu, opcode, a, specials[random() % specials.size()], specials[random() % specials.size()], mode);
    }
  }
}
