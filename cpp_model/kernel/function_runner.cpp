// Decodes intermediate code into steps, and runs them.
#include "kernel/function_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <stdexcept>

#include "arith/arith.hpp"
#include "bits.hpp"
#include "isa/input_error.hpp"
#include "kernel/native.hpp"

namespace raypool::kernel {
namespace {

// Values of a thread, by number: its arguments, its indices, its ray words, then constants and registers. So an operand
// is a number, whatever it was in the instruction.
constexpr uint32_t kIndices = kArguments;  // thread, block, threads, blocks
constexpr uint32_t kWords = kIndices + 4;
constexpr uint32_t kOwn = kWords + kIntersectionWords;

// What is done in one step, with d, a, b, c of its Code.
//   ROW(name, expression): value d becomes the expression, in values a and b (as signed numbers sa and sb) and the
//   mode; predicate d becomes it under mask c; in the logic steps a and b are predicates
#define RAYPOOL_VALUE_STEPS(ROW)                  \
  ROW(Mov, a)                                     \
  ROW(Iadd, a + b)                                \
  ROW(Isub, a - b)                                \
  ROW(Imul, a* b)                                 \
  ROW(And, a& b)                                  \
  ROW(Or, a | b)                                  \
  ROW(Xor, a ^ b)                                 \
  ROW(Shl, a << (b & 31))                         \
  ROW(Shr, a >> (b & 31))                         \
  ROW(Sar, static_cast<uint32_t>(sa >> (b & 31))) \
  ROW(Imin, sa < sb ? a : b)                      \
  ROW(Imax, sa > sb ? a : b)                      \
  ROW(Umin, std::min(a, b))                       \
  ROW(Umax, std::max(a, b))                       \
  ROW(Fadd, arith::add(a, b, mode))               \
  ROW(Fsub, arith::sub(a, b, mode))               \
  ROW(Fmul, arith::mul(a, b, mode))               \
  ROW(Fmin, arith::min(a, b, mode))               \
  ROW(Fmax, arith::max(a, b, mode))               \
  ROW(F2i, arith::to_int(a, mode))                \
  ROW(I2f, arith::from_int(a, mode))              \
  ROW(Fdiv, arith::div(a, b, mode))               \
  ROW(Fsqrt, arith::sqrt(a, mode))                \
  ROW(Frsqrt, arith::rsqrt(a, mode))              \
  ROW(Frcp, arith::rcp(a, mode))
#define RAYPOOL_COMPARE_STEPS(ROW)        \
  ROW(Ieq, a == b)                        \
  ROW(Ine, a != b)                        \
  ROW(Ilt, sa < sb)                       \
  ROW(Ile, sa <= sb)                      \
  ROW(Igt, sa > sb)                       \
  ROW(Ige, sa >= sb)                      \
  ROW(Ult, a < b)                         \
  ROW(Ule, a <= b)                        \
  ROW(Ugt, a > b)                         \
  ROW(Uge, a >= b)                        \
  ROW(Feq, arith::equal(a, b, mode))      \
  ROW(Fne, arith::not_equal(a, b, mode))  \
  ROW(Flt, arith::less(a, b, mode))       \
  ROW(Fle, arith::less_equal(a, b, mode)) \
  ROW(Fgt, arith::greater(a, b, mode))    \
  ROW(Fge, arith::greater_equal(a, b, mode))

#define RAYPOOL_LOGIC_STEPS(ROW) \
  ROW(Pand, a& b)                \
  ROW(Por, a | b)                \
  ROW(Pxor, a ^ b)               \
  ROW(Pandn, a & ~b)

enum class Step : uint32_t {
#define RAYPOOL_ROW(name, expression) name,
  RAYPOOL_VALUE_STEPS(RAYPOOL_ROW) RAYPOOL_COMPARE_STEPS(RAYPOOL_ROW) RAYPOOL_LOGIC_STEPS(RAYPOOL_ROW)
#undef RAYPOOL_ROW
      Ffma,  // d = a * b + c
  Sel,       // d = predicate c ? a : b
  Load,      // d = memory at a + immediate b
  Store,     // memory at a + immediate b = c
  Import,
  Export,      // under mask c
  Contribute,  // under mask c
  Unless,      // goes to step d unless mask c is on
  If,          // goes to step d if mask c is on
  Again,       // goes back to step d, the begin of loop a, which has b steps
  Exit,
};

Step step_of(Opcode opcode) {
  switch (opcode) {
#define RAYPOOL_ROW(name, expression) \
  case Opcode::name:                  \
    return Step::name;
    RAYPOOL_VALUE_STEPS(RAYPOOL_ROW)
    RAYPOOL_COMPARE_STEPS(RAYPOOL_ROW)
    RAYPOOL_LOGIC_STEPS(RAYPOOL_ROW)
    RAYPOOL_ROW(Ffma, )
    RAYPOOL_ROW(Sel, )
    RAYPOOL_ROW(Exit, )
#undef RAYPOOL_ROW
    case Opcode::Arg:
    case Opcode::Tid:
    case Opcode::Block:
    case Opcode::Threads:
    case Opcode::Blocks:
    case Opcode::Unit:
    case Opcode::Rld:
    case Opcode::Rst:
      return Step::Mov;
    case Opcode::Ld:
      return Step::Load;
    case Opcode::St:
      return Step::Store;
    case Opcode::Inval:  // there is no cache
    case Opcode::Rin:
      return Step::Import;
    case Opcode::Rout:
      return Step::Export;
    case Opcode::Rfb:
      return Step::Contribute;
    case Opcode::Jnone:
    case Opcode::Loop:
      return Step::Unless;
    case Opcode::Jany:
      return Step::If;
    default:
      throw std::logic_error("a kernel that runs natively has an instruction that is not recorded: " +
                             std::string(instruction(opcode).mnemonic));
  }
}

/// A mask in a step: predicate and negation in one number.
uint32_t mask_of(const Guard& guard) { return static_cast<uint32_t>(guard.predicate) << 1 | (guard.negated ? 1 : 0); }

}  // namespace

/// Steps do not look at masks; those that have one stand behind an Unless, which leads around all that share it.
struct FunctionRunner::Builder {
  FunctionRunner& runner;
  const Function& function;
  std::vector<uint32_t> definitions;        // [register] how many ops write it
  std::vector<uint32_t> alias;              // [register] the value that it equals always, or 0
  std::vector<uint32_t> places;             // [register] where it is, or 0
  std::map<uint32_t, uint32_t> constants;   // bits -> value
  std::vector<uint32_t> label_at, loop_at;  // steps
  std::vector<std::pair<size_t, int>> jumps;
  std::optional<size_t> open;  // an Unless that leads to the next step not of its mask
  Guard open_guard, known;     // `known`: a mask that is on here
  uint32_t registers = 0;

  Builder(FunctionRunner& made, const Function& from) : runner(made), function(from) {
    const auto count = static_cast<size_t>(function.registers);
    definitions.assign(count, 0);
    alias.assign(count, 0);
    places.assign(count, 0);
    label_at.assign(static_cast<size_t>(function.labels), 0);
    loop_at = label_at;
    for (const Op& op : function.ops) {
      if (op.kind == Op::Kind::Instruction && is_triple(*op.info)) step_of(op.info->opcode);
      if (op.kind != Op::Kind::Instruction) continue;
      if (const int written = effects(op).register_defined; written != kNothing) ++definitions[index(written)];
    }
    for (const Op& op : function.ops) find_constants(op);
    for (const Op& op : function.ops) find_alias(op);
  }

  static size_t index(int number) { return static_cast<size_t>(number); }

  uint32_t constant(uint32_t bits) {
    const auto [place, is_new] = constants.emplace(bits, kOwn + size32(runner.initial_));
    if (is_new) runner.initial_.push_back(bits);
    return place->second;
  }

  /// All constants lie before the registers.
  void find_constants(const Op& op) {
    if (op.kind == Op::Kind::Instruction && has_operand(*op.info, Operand::B) && op.b_is_immediate)
      constant(op.immediate);
    if (is(op, Opcode::Unit)) constant(0);
  }

  /// The value that such an op gives whenever it is executed, or 0.
  uint32_t fixed_value(const Op& op) {
    switch (op.info->opcode) {
      case Opcode::Mov:
        return op.b_is_immediate ? constant(op.immediate) : 0;
      case Opcode::Tid:
        return kIndices;
      case Opcode::Block:
        return kIndices + 1;
      case Opcode::Threads:
        return kIndices + 2;
      case Opcode::Blocks:
        return kIndices + 3;
      case Opcode::Unit:
        return constant(0);  // there is one
      default:
        return 0;
    }
  }

  // What no other op writes holds this one value wherever it is defined, so that readers can take it from where it is.
  // An argument's number may be 0, which no alias has: it is copied.
  void find_alias(const Op& op) {
    if (op.kind != Op::Kind::Instruction || op.rd == kNothing || !writes_register(*op.info)) return;
    if (definitions[index(op.rd)] != 1) return;
    alias[index(op.rd)] = is(op, Opcode::Arg) ? op.immediate : fixed_value(op);
  }

  uint32_t value(int number) {
    if (alias[index(number)] != 0) return alias[index(number)];
    uint32_t& place = places[index(number)];
    if (place == 0) {
      place = kOwn + size32(runner.initial_);
      runner.initial_.push_back(kUndefinedWord);
    }
    return place;
  }
  uint32_t operand_b(const Op& op) { return op.b_is_immediate ? constant(op.immediate) : value(op.rb); }

  void close() {
    if (open) runner.codes_[*open].d = size32(runner.codes_);
    open.reset();
  }

  void jump(Step step, const Op& op) {
    close();
    jumps.emplace_back(runner.codes_.size(), op.label);
    add(step, 0, 0, 0, mask_of(op.guard));
    known = step == Step::Unless ? op.guard : Guard{};
  }

  void add(Step step, uint32_t d, uint32_t a, uint32_t b, uint32_t c) {
    runner.codes_.push_back({static_cast<uint32_t>(step), d, a, b, c});
  }

  /// From here on steps run under this mask.
  void enter(const Guard& guard) {
    if (open && open_guard == guard) return;
    close();
    if (guard.all() || guard == known) return;
    open = runner.codes_.size();
    open_guard = guard;
    add(Step::Unless, 0, 0, 0, mask_of(guard));
  }

  void build() {
    for (const Op& op : function.ops) {
      if (op.kind == Op::Kind::Instruction) {
        instruction(op);
        continue;
      }
      if (op.kind == Op::Kind::Undefined) continue;
      close();
      known = {};
      if (op.kind == Op::Kind::LoopEnd) {
        const uint32_t begin = loop_at[index(op.label)];
        add(Step::Again, begin, size32(runner.loops_), size32(runner.codes_) - begin, 0);
        runner.loops_.push_back(to_string(loop_place(op.label)));
      }
      label_at[index(op.label)] = size32(runner.codes_);
    }
    close();
    for (const auto& [at, label] : jumps) runner.codes_[at].d = label_at[index(label)];
  }

  const Location& loop_place(int label) const {
    return std::find_if(function.ops.begin(), function.ops.end(),
                        [&](const Op& op) { return is(op, Opcode::Loop) && op.label == label; })
        ->where;
  }

  void instruction(const Op& op) {
    const Step step = step_of(op.info->opcode);
    if (writes_predicate(*op.info)) return predicate(op, step);
    const uint32_t mask = mask_of(op.guard);
    switch (op.info->opcode) {
      case Opcode::Loop:
        close();
        loop_at[index(op.label)] = size32(runner.codes_);
        return jump(step, op);
      case Opcode::Jnone:
      case Opcode::Jany:
        return jump(step, op);
      // Whatever the mask, they concern the whole warp: threads outside lose their words too.
      case Opcode::Rin:
      case Opcode::Rout:
      case Opcode::Rfb:
      case Opcode::Exit:
        close();
        return add(step, 0, 0, 0, mask);
      default:
        break;
    }
    if (op.rd != kNothing && writes_register(*op.info) && alias[index(op.rd)] != 0) return;
    if (is(op, Opcode::Inval)) return;
    enter(op.guard);
    switch (op.info->opcode) {
      case Opcode::Ld:
        return add(step, value(op.rd), value(op.ra), op.immediate, 0);
      case Opcode::St:
        return add(step, 0, value(op.ra), op.immediate, value(op.rb));
      case Opcode::Arg:
        return add(step, value(op.rd), op.immediate, 0, 0);
      case Opcode::Rld:
        return add(step, value(op.rd), kWords + op.word, 0, 0);
      case Opcode::Rst:
        return add(step, kWords + op.word, operand_b(op), 0, 0);
      case Opcode::Mov:
        return add(step, value(op.rd), operand_b(op), 0, 0);
      case Opcode::Tid:
      case Opcode::Block:
      case Opcode::Threads:
      case Opcode::Blocks:
      case Opcode::Unit:
        return add(step, value(op.rd), fixed_value(op), 0, 0);
      default:
        break;
    }
    const bool binary = has_operand(*op.info, Operand::B);
    const uint32_t c = step == Step::Ffma ? value(op.rc) : step == Step::Sel ? static_cast<uint32_t>(op.px) : 0;
    add(step, value(op.rd), value(op.ra), binary ? operand_b(op) : 0, c);
  }

  // Written in all lanes: where the mask is off, 0.
  void predicate(const Op& op, Step step) {
    close();
    if (op.rd == 0) return;  // p0 is never written
    const bool logic = has_operand(*op.info, Operand::Px);
    add(step, static_cast<uint32_t>(op.rd), logic ? static_cast<uint32_t>(op.px) : value(op.ra),
        logic ? static_cast<uint32_t>(op.rb) : operand_b(op), mask_of(op.guard));
    if (known.predicate == op.rd) known = {};
  }
};

/// A thread's values and predicates. Their memory is kept for the next thread.
class FunctionRunner::Scratch {
 public:
  void begin(const NativeThread& thread, const std::vector<uint32_t>& initial, uint32_t predicates) {
    if (values_.size() < kOwn + initial.size()) values_.resize(kOwn + initial.size());
    predicates_.assign(predicates, 0);
    value = values_.data();
    predicate = predicates_.data();
    predicate[0] = 1;
    std::copy(thread.arguments->begin(), thread.arguments->end(), value);
    const std::array<uint32_t, 4> indices = {thread.thread, thread.block, thread.threads, thread.blocks};
    std::copy(indices.begin(), indices.end(), value + kIndices);
    forget_words();
    std::copy(initial.begin(), initial.end(), value + kOwn);
  }
  bool on(uint32_t mask) const { return predicate[mask >> 1] != (mask & 1); }
  void forget_words() { std::fill_n(value + kWords, kIntersectionWords, kUndefinedWord); }
  void export_ray(NativeThread& thread, uint32_t mask) {
    if (on(mask)) {
      Ray ray;
      std::copy_n(value + kWords, ray.size(), ray.begin());
      thread.rays.push_back(ray);
    }
    forget_words();
  }
  void contribute(NativeThread& thread, uint32_t mask) {
    const uint32_t* const words = value + kWords;
    if (on(mask)) {
      thread.frame.push_back(
          {words[word::kPixel], {words[word::kColor], words[word::kColor + 1], words[word::kColor + 2]}});
    }
    forget_words();
  }

  uint32_t* value = nullptr;
  uint8_t* predicate = nullptr;

 private:
  std::vector<uint32_t> values_;
  std::vector<uint8_t> predicates_;
};

FunctionRunner::FunctionRunner(const Function& function, uint64_t most_operations)
    : name_(function.name), predicates_(static_cast<uint32_t>(function.predicates)), most_operations_(most_operations) {
  Builder(*this, function).build();
}

void FunctionRunner::fail_endless(const Code& end) const {
  throw InputError(
      fmt::format("kernel '{}': the loop of {} has not ended after {} operations of one thread; give it a bound that "
                  "every thread reaches",
                  name_, loops_[end.a], most_operations_));
}

#define RAYPOOL_VALUE(name, expression)                                                     \
  case Step::name: {                                                                        \
    [[maybe_unused]] const uint32_t a = value[code->a], b = value[code->b];                 \
    [[maybe_unused]] const auto sa = static_cast<int32_t>(a), sb = static_cast<int32_t>(b); \
    value[code->d] = expression;                                                            \
    break;                                                                                  \
  }
#define RAYPOOL_COMPARE(name, expression)                                                   \
  case Step::name: {                                                                        \
    [[maybe_unused]] const uint32_t a = value[code->a], b = value[code->b];                 \
    [[maybe_unused]] const auto sa = static_cast<int32_t>(a), sb = static_cast<int32_t>(b); \
    predicate[code->d] = static_cast<uint8_t>(int{expression} & int{on(code->c)});          \
    break;                                                                                  \
  }
#define RAYPOOL_LOGIC(name, expression)                                         \
  case Step::name: {                                                            \
    const int a = predicate[code->a], b = predicate[code->b];                   \
    predicate[code->d] = static_cast<uint8_t>((expression) & int{on(code->c)}); \
    break;                                                                      \
  }

template <bool kFlush, bool kNarrow>
void FunctionRunner::run_in_mode(NativeThread& thread) const {
  const arith::Mode mode = {kFlush ? Subnormals::Flush : Subnormals::Ieee, thread.mode.slow_unit, thread.mode.fused,
                            kNarrow ? thread.mode.significand : arith::kFullSignificand};
  static thread_local Scratch state;
  state.begin(thread, initial_, predicates_);
  uint32_t* const value = state.value;
  uint8_t* const predicate = state.predicate;
  const auto on = [predicate](uint32_t mask) { return predicate[mask >> 1] != (mask & 1); };
  uint64_t operations = 0;
  const Code* const codes = codes_.data();
  for (const Code* code = codes;; ++code) {
    switch (static_cast<Step>(code->code)) {
      RAYPOOL_VALUE_STEPS(RAYPOOL_VALUE)
      RAYPOOL_COMPARE_STEPS(RAYPOOL_COMPARE)
      RAYPOOL_LOGIC_STEPS(RAYPOOL_LOGIC)
      case Step::Ffma:
        value[code->d] = arith::fma(value[code->a], value[code->b], value[code->c], mode);
        break;
      case Step::Sel:
        value[code->d] = predicate[code->c] != 0 ? value[code->a] : value[code->b];
        break;
      case Step::Load:
        value[code->d] = thread.memory->load(value[code->a] + code->b);
        break;
      case Step::Store:
        thread.memory->store(value[code->a] + code->b, value[code->c]);
        break;
      case Step::Import:
        std::copy(thread.input.begin(), thread.input.end(), value + kWords);
        break;
      case Step::Export:
        state.export_ray(thread, code->c);
        break;
      case Step::Contribute:
        state.contribute(thread, code->c);
        break;
      case Step::Unless:
        if (!on(code->c)) code = codes + code->d - 1;
        break;
      case Step::If:
        if (on(code->c)) code = codes + code->d - 1;
        break;
      case Step::Again:
        operations += code->b;
        if (operations > most_operations_) fail_endless(*code);
        code = codes + code->d - 1;
        break;
      case Step::Exit:
        return;
    }
  }
}

void FunctionRunner::run(NativeThread& thread) const {
  const bool flush = thread.mode.subnormals != Subnormals::Ieee;
  if (thread.mode.narrow())
    flush ? run_in_mode<true, true>(thread) : run_in_mode<false, true>(thread);
  else
    flush ? run_in_mode<true, false>(thread) : run_in_mode<false, false>(thread);
}

}  // namespace raypool::kernel
