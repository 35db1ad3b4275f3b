// The model of arithmetic against its oracles (cpp_model/arith/test_oracle.hpp, test_newton.hpp), as
// far as a machine can go in minutes:
//   numerics_long [PAIRS [STRIDE [THREADS [SIGNIFICAND]]]]
// Unary operations over every STRIDE-th of all 2^32 inputs (default: all); binary and ternary ones over all pairs and
// triples of special and boundary operands and over PAIRS weighted random ones (default 10^8); THREADS is 1 unless it
// is given. MPFR judges ffma and frsqrt once more, frsqrt over every 257th input at most. The Newton units: the same
// pairs, and of unary operations every mantissa of both parities and of the results at both ends, and every 257th
// input. With significands of 20, 16, 13 and 11 bits, or of one of them alone if SIGNIFICAND names it: a tenth of the
// pairs, and of unary operations every 257th input and every mantissa; MPFR judges. Prints inputs tried and errors;
// exit code 1 if there are any. The seeds are fixed, so a run can be repeated.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

#include "arith/test_newton.hpp"
#include "arith/test_operands.hpp"
#include "arith/test_oracle.hpp"
#include "enum_array.hpp"
#include "numerics/long_table.hpp"

namespace raypool::arith {
namespace {

constexpr size_t kBlock = 1 << 14;
constexpr uint64_t kSparse = 257;  // MPFR takes some 40 times as long as the integers do
constexpr Operation kUnary[] = {Operation::ToInt, Operation::FromInt, Operation::Sqrt, Operation::Rcp,
                                Operation::Rsqrt};
constexpr Operation kBinary[] = {Operation::Add,  Operation::Sub,       Operation::Mul,     Operation::Div,
                                 Operation::Min,  Operation::Max,       Operation::Equal,   Operation::NotEqual,
                                 Operation::Less, Operation::LessEqual, Operation::Greater, Operation::GreaterEqual};

/// The judge: the first oracle of an operation, MPFR once more, or the definition of a Newton unit.
enum class Judge : uint8_t { First, Mpfr, Newton2, Newton1, Newton0 };
constexpr Judge kNewton[] = {Judge::Newton2, Judge::Newton1, Judge::Newton0};
constexpr int kJudges = 5;
constexpr const char* kJudgeNames[kJudges] = {"", ", MPFR", ", newton2", ", newton1", ", newton0"};
constexpr EnumArray<Judge, SlowUnit, kJudges> kUnits = {SlowUnit::Exact, SlowUnit::Exact, SlowUnit::Newton2,
                                                        SlowUnit::Newton1, SlowUnit::Newton0};

struct Tally {
  std::atomic<uint64_t> inputs{0}, errors{0};
};
constexpr uint32_t kSignificands[] = {24, 20, 16, 13, 11};
/// The one that is being tried; the number of an element of kSignificands.
size_t width = 0;
uint32_t significand() { return kSignificands[width]; }
/// One a significand, judge, operation and mode (0 ieee, 1 flush).
std::array<std::array<Tally, 2>, std::size(kSignificands) * kJudges * kOperations> tallies;
std::mutex output;
unsigned threads_wanted = 1;

size_t index_of(Operation operation, Judge judge) {
  return (width * kJudges + static_cast<size_t>(judge)) * kOperations + static_cast<size_t>(operation);
}
std::string name_of(size_t index) {
  const size_t judge = index / kOperations;
  return kOperationNames[index % kOperations] + std::string(kJudgeNames[judge % kJudges]) +
         of_significand(kSignificands[judge / kJudges]);
}

/// The right results. Those of a Newton unit must keep the exact result's exponent too; one that does not is none.
void judge_block(Operation operation, const OperandBlock& in, Judge judge, bool flush,
                 std::vector<uint32_t>& expected) {
  const SlowUnit unit = kUnits[judge];
  if (significand() == arith::kFullSignificand) {
    oracle::results(operation, in, flush, judge == Judge::Mpfr, expected);
  } else {
    oracle::narrow_results(operation, in, flush, significand(), expected);
  }
  if (unit == SlowUnit::Exact) return;
  for (size_t i = 0; i < in.size(); ++i) {
    const uint32_t newton = newton_oracle::result(operation, in.a[i], in.b[i], unit, flush, significand());
    if (newton_oracle::keeps_exponent(operation, in.a[i], in.b[i], newton, expected[i], significand()))
      expected[i] = newton;
  }
}

void check(Operation operation, const OperandBlock& in, Judge judge, std::vector<uint32_t>& expected) {
  const size_t index = index_of(operation, judge);
  for (const bool flush : {false, true}) {
    judge_block(operation, in, judge, flush, expected);
    const Mode mode{flush ? Subnormals::Flush : Subnormals::Ieee, kUnits[judge], false, significand()};
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

/// Runs part(0) .. part(parts - 1) on as many threads as are wanted and shows how far it is.
void run_parts(const std::string& what, uint64_t parts, const std::function<void(uint64_t)>& part) {
  const auto start = std::chrono::steady_clock::now();
  std::atomic<uint64_t> next{0}, done{0};
  const bool to_terminal = isatty(STDERR_FILENO) != 0;
  std::vector<std::thread> threads;
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  for (unsigned i = 0; i < threads_wanted; ++i) {
    threads.emplace_back([&] {
      for (uint64_t number; (number = next++) < parts;) {
        part(number);
        const uint64_t finished = ++done;
        if (to_terminal && finished % std::max<uint64_t>(1, parts / 100) == 0) {
          std::fprintf(stderr, "\r%-34s %3.0f%%  %.0f s ", what.c_str(), 100.0 * finished / parts, seconds());
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  if (to_terminal) std::fputc('\r', stderr);
  std::printf("%-34s %.0f s\n", what.c_str(), seconds());
  std::fflush(stdout);
}

/// Inputs first, first + stride .. below end.
void unary_operation(Operation operation, uint64_t first, uint64_t end, uint64_t stride, Judge judge) {
  const uint64_t inputs = (end - first + stride - 1) / stride;
  run_parts(name_of(index_of(operation, judge)), (inputs + kBlock - 1) / kBlock, [&](uint64_t part) {
    thread_local OperandBlock in;
    thread_local std::vector<uint32_t> expected;
    in.clear();
    for (uint64_t i = part * kBlock; i < std::min(inputs, (part + 1) * kBlock); ++i)
      in.push(static_cast<uint32_t>(first + i * stride), 0, 0);
    check(operation, in, judge, expected);
  });
}

constexpr uint64_t kAll = uint64_t{1} << 32;

/// A Newton result's bits depend on the mantissa and, of roots, on the parity of the
/// exponent; at the ends of the range on more.
void unary_newton(Operation operation, uint64_t stride, Judge judge) {
  unary_operation(operation, 0x3f800000u, 0x40800000u, stride, judge);
  unary_operation(operation, 0x00000000u, 0x01000000u, stride, judge);
  unary_operation(operation, 0x7e000000u, 0x80000000u, stride, judge);
  unary_operation(operation, 0, kAll, std::max(stride, kSparse), judge);
}

void special_operands_of_all_kinds() {
  const std::vector<uint32_t> specials = boundary_operands(significand());
  const std::string name = fmt::format("{0}^2, {0}^3 specials", specials.size()) + of_significand(significand());
  run_parts(name, specials.size(), [&](uint64_t part) {
    OperandBlock in;
    std::vector<uint32_t> expected;
    for (const uint32_t b : specials) in.push(specials[part], b, 0);
    for (const Operation operation : kBinary) check(operation, in, Judge::First, expected);
    for (const Judge judge : kNewton) check(Operation::Div, in, judge, expected);
    // MPFR takes some 40 times as long as the host's unit.
    const size_t step = significand() == arith::kFullSignificand ? 1 : 7;
    for (const uint32_t b : specials) {
      in.clear();
      for (size_t c = b % step; c < specials.size(); c += step) in.push(specials[part], b, specials[c]);
      check(Operation::Fma, in, Judge::First, expected);
    }
  });
}

void random_operands(uint64_t pairs) {
  run_parts("weighted random" + of_significand(significand()), (pairs + kBlock - 1) / kBlock, [&](uint64_t part) {
    thread_local OperandBlock in;
    thread_local std::vector<uint32_t> expected;
    OperandSource source(part, significand());
    in.clear();
    for (uint64_t i = part * kBlock; i < std::min(pairs, (part + 1) * kBlock); ++i) {
      const auto [a, b] = source.next();
      in.push(a, b, source.third(a, b));
    }
    for (const Operation operation : kBinary) check(operation, in, Judge::First, expected);
    for (const Judge judge : kNewton) check(Operation::Div, in, judge, expected);
    check(Operation::Fma, in, Judge::First, expected);
    if (significand() == arith::kFullSignificand) check(Operation::Fma, in, Judge::Mpfr, expected);
  });
}

void shorter_significand(uint64_t pairs, uint64_t stride) {
  special_operands_of_all_kinds();
  random_operands(pairs / 10);
  for (const Operation operation : kUnary) {
    unary_operation(operation, 0, kAll, std::max(stride, kSparse), Judge::First);
    unary_operation(operation, 0x3f800000u, 0x40800000u, uint64_t{1} << (24 - significand()), Judge::First);
  }
  for (const Operation operation : {Operation::Sqrt, Operation::Rsqrt, Operation::Rcp}) {
    for (const Judge judge : kNewton) unary_newton(operation, std::max(stride, kSparse), judge);
  }
}

/// A positive integer; throws std::runtime_error.
uint64_t count_of(const char* text) {
  char* end = nullptr;
  const uint64_t value = std::strtoull(text, &end, 10);
  if (value == 0 || *end != '\0' || *text == '-') {
    throw std::runtime_error(fmt::format(
        "'{}' must be a whole number above 0; numerics_long [PAIRS [STRIDE [THREADS [SIGNIFICAND]]]]", text));
  }
  return value;
}

void full_significand(uint64_t pairs, uint64_t stride) {
  special_operands_of_all_kinds();
  random_operands(pairs);
  for (const Operation operation : kUnary) unary_operation(operation, 0, kAll, stride, Judge::First);
  unary_operation(Operation::Rsqrt, 0, kAll, std::max(stride, kSparse), Judge::Mpfr);
  for (const Operation operation : {Operation::Sqrt, Operation::Rsqrt, Operation::Rcp}) {
    for (const Judge judge : kNewton) unary_newton(operation, stride, judge);
  }
}

int run(int argc, char** argv) {
  const uint64_t pairs = argc > 1 ? count_of(argv[1]) : 100'000'000;
  const uint64_t stride = argc > 2 ? count_of(argv[2]) : 1;
  threads_wanted = argc > 3 ? static_cast<unsigned>(std::min<uint64_t>(count_of(argv[3]), 256)) : 1;
  const uint64_t only = argc > 4 ? count_of(argv[4]) : 0;
  if (only != 0 && std::find(std::begin(kSignificands), std::end(kSignificands), only) == std::end(kSignificands))
    throw std::runtime_error(fmt::format("significand {} is none of 24, 20, 16, 13 and 11", only));
  std::printf(
      "oracles: SSE%s; integers for frsqrt and Newton units; MPFR %s for fmin and fmax, and where the table names it\n",
      host_has_fma() ? " and FMA of this host" : " of this host", mpfr_get_version());
  for (width = 0; width < std::size(kSignificands); ++width) {
    if (only != 0 && only != significand()) continue;
    significand() == arith::kFullSignificand ? full_significand(pairs, stride) : shorter_significand(pairs, stride);
  }
  uint64_t errors = 0;
  std::printf("\n");
  print_long_head();
  for (size_t i = 0; i < tallies.size(); ++i) {
    const LongCount ieee{tallies[i][0].inputs, tallies[i][0].errors}, flush{tallies[i][1].inputs, tallies[i][1].errors};
    if (ieee.inputs > 0) print_long_row(name_of(i), ieee, flush);
    errors += ieee.errors + flush.errors;
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
