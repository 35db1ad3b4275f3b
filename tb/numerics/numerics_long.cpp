// The model of arithmetic against its oracles (cpp_model/arith/test_oracle.hpp), as far as a machine can go in minutes:
//   numerics_long [PAIRS [STRIDE]]
// Unary operations over every STRIDE-th of all 2^32 inputs (default: all); binary and ternary ones over all pairs and triples of
// special and boundary operands and over PAIRS weighted random ones (default 10^8). Prints inputs tried and errors; exit code 1
// if there are any. The seeds are fixed, so a run can be repeated.
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

#include "arith/test_operands.hpp"
#include "arith/test_oracle.hpp"

namespace raypool::arith {
namespace {

constexpr size_t kBlock = 1 << 14;
constexpr Operation kUnary[] = {Operation::ToInt, Operation::FromInt, Operation::Sqrt, Operation::Rcp, Operation::Rsqrt};
constexpr Operation kBinary[] = {Operation::Add, Operation::Sub,   Operation::Mul,  Operation::Div,      Operation::Min,
                                 Operation::Max, Operation::Equal, Operation::Less, Operation::LessEqual};

struct Tally {
  std::atomic<uint64_t> inputs{0}, errors{0};
};
/// One an operation and mode (0 ieee, 1 flush); the last one is ffma judged by MPFR.
std::array<std::array<Tally, 2>, kOperations + 1> tallies;
std::mutex output;

std::string name_of(size_t index) { return index == static_cast<size_t>(kOperations) ? "ffma, MPFR" : kOperationNames[index]; }

void check(Operation operation, const OperandBlock& in, bool with_mpfr, std::vector<uint32_t>& expected) {
  const size_t index = with_mpfr ? static_cast<size_t>(kOperations) : static_cast<size_t>(operation);
  for (const bool flush : {false, true}) {
    oracle::results(operation, in, flush, with_mpfr, expected);
    const Mode mode{flush ? Subnormals::Flush : Subnormals::Ieee, SlowUnit::Exact};
    uint64_t errors = 0;
    for (size_t i = 0; i < in.size(); ++i) {
      const uint32_t ours = model(operation, in.a[i], in.b[i], in.c[i], mode);
      if (ours == expected[i]) continue;
      if (tallies[index][flush].errors + errors++ >= 5) continue;
      const std::lock_guard<std::mutex> lock(output);
      std::printf("WRONG %s %s: a %08x b %08x c %08x: model %08x, oracle %08x\n", name_of(index).c_str(),
                  flush ? "flush" : "ieee", in.a[i], in.b[i], in.c[i], ours, expected[i]);
    }
    tallies[index][flush].inputs += in.size();
    tallies[index][flush].errors += errors;
  }
}

/// Runs part(0) .. part(parts - 1) on all processors and shows how far it is.
void run_parts(const std::string& what, uint64_t parts, const std::function<void(uint64_t)>& part) {
  const auto start = std::chrono::steady_clock::now();
  std::atomic<uint64_t> next{0}, done{0};
  const bool to_terminal = isatty(STDERR_FILENO) != 0;
  std::vector<std::thread> threads;
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i) {
    threads.emplace_back([&] {
      for (uint64_t number; (number = next++) < parts;) {
        part(number);
        const uint64_t finished = ++done;
        if (to_terminal && finished % std::max<uint64_t>(1, parts / 100) == 0) {
          std::fprintf(stderr, "\r%-24s %3.0f%%  %.0f s ", what.c_str(),
                       100.0 * static_cast<double>(finished) / static_cast<double>(parts), seconds());
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  if (to_terminal) std::fputc('\r', stderr);
  std::printf("%-24s %.0f s\n", what.c_str(), seconds());
  std::fflush(stdout);
}

void unary_operations(uint64_t stride) {
  const uint64_t inputs = ((uint64_t{1} << 32) + stride - 1) / stride;
  for (const Operation operation : kUnary) {
    run_parts(kOperationNames[static_cast<int>(operation)], (inputs + kBlock - 1) / kBlock, [&](uint64_t part) {
      thread_local OperandBlock in;
      thread_local std::vector<uint32_t> expected;
      in.clear();
      for (uint64_t i = part * kBlock; i < std::min(inputs, (part + 1) * kBlock); ++i)
        in.push(static_cast<uint32_t>(i * stride), 0, 0);
      check(operation, in, false, expected);
    });
  }
}

void special_operands_of_all_kinds() {
  const std::vector<uint32_t> specials = boundary_operands();
  run_parts(fmt::format("{}^2, {}^3 specials", specials.size(), specials.size()), specials.size(), [&](uint64_t part) {
    OperandBlock in;
    std::vector<uint32_t> expected;
    for (const uint32_t b : specials) in.push(specials[part], b, 0);
    for (const Operation operation : kBinary) check(operation, in, false, expected);
    for (const uint32_t b : specials) {
      in.clear();
      for (const uint32_t c : specials) in.push(specials[part], b, c);
      check(Operation::Fma, in, false, expected);
    }
  });
}

void random_operands(uint64_t pairs) {
  run_parts("weighted random", (pairs + kBlock - 1) / kBlock, [&](uint64_t part) {
    thread_local OperandBlock in;
    thread_local std::vector<uint32_t> expected;
    OperandSource source(part);
    in.clear();
    for (uint64_t i = part * kBlock; i < std::min(pairs, (part + 1) * kBlock); ++i) {
      const auto [a, b] = source.next();
      in.push(a, b, source.third(a, b));
    }
    for (const Operation operation : kBinary) check(operation, in, false, expected);
    check(Operation::Fma, in, false, expected);
    check(Operation::Fma, in, true, expected);
  });
}

/// A positive integer; throws std::runtime_error.
uint64_t count_of(const char* text) {
  char* end = nullptr;
  const uint64_t value = std::strtoull(text, &end, 10);
  if (value == 0 || *end != '\0' || *text == '-') {
    throw std::runtime_error(fmt::format("'{}' must be a whole number above 0; numerics_long [PAIRS [STRIDE]]", text));
  }
  return value;
}

int run(int argc, char** argv) {
  const uint64_t pairs = argc > 1 ? count_of(argv[1]) : 100'000'000;
  const uint64_t stride = argc > 2 ? count_of(argv[2]) : 1;
  std::printf("oracles: SSE%s; MPFR %s for fmin fmax frsqrt and ffma\n",
              host_has_fma() ? " and FMA of this host" : " of this host", mpfr_get_version());
  special_operands_of_all_kinds();
  random_operands(pairs);
  unary_operations(stride);
  uint64_t errors = 0;
  std::printf("\n%-12s%16s%10s%16s%10s\n", "operation", "inputs, ieee", "errors", "inputs, flush", "errors");
  for (size_t i = 0; i < tallies.size(); ++i) {
    std::printf("%-12s", name_of(i).c_str());
    for (const Tally& tally : tallies[i]) {
      std::printf("%16llu%10llu", static_cast<unsigned long long>(tally.inputs), static_cast<unsigned long long>(tally.errors));
      errors += tally.errors;
    }
    std::printf("\n");
  }
  std::printf("numerics_long: %llu errors\n", static_cast<unsigned long long>(errors));
  return errors == 0 ? 0 : 1;
}

}  // namespace
}  // namespace raypool::arith

int main(int argc, char** argv) {
  try {
    return raypool::arith::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "numerics_long: %s\n", error.what());
    return 1;
  }
}
