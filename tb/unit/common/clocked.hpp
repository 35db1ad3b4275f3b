// A Verilated block in reset, then clocked, with random numbers for its bench.
#pragma once

#include <cstdint>
#include <memory>
#include <random>

namespace raypool::bench {

template <typename Unit>
class Clocked {
 public:
  explicit Clocked(uint32_t seed) : random(seed) {
    u->clk_i = 0;
    u->rst_ni = 0;
    clock();
    clock();
    u->rst_ni = 1;
  }
  ~Clocked() { u->final(); }
  Clocked(const Clocked&) = delete;
  Clocked& operator=(const Clocked&) = delete;

  void clock() {
    u->eval();
    u->clk_i = 1;
    u->eval();
    u->clk_i = 0;
  }
  /// True once in so many times.
  bool one_of(uint32_t n) { return random() % n == 0; }

  std::unique_ptr<Unit> u = std::make_unique<Unit>();
  std::mt19937 random;
};

}  // namespace raypool::bench
