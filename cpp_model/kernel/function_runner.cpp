// Decodes intermediate code into steps, and runs them.
#include "kernel/function_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>

#include "bits.hpp"
#include "isa/input_error.hpp"
#include "kernel/lanes.hpp"
#include "kernel/liveness.hpp"
#include "kernel/native.hpp"

namespace raypool::kernel {
namespace {

static_assert(kLanes == FunctionRunner::kMostThreads);

/// A word of each thread. Of a predicate: all bits in threads that have it, none in others.
struct Row {
  Words lane;
};
[[gnu::always_inline]] inline Row filled(uint32_t bits) { return {Words{} + bits}; }

// Rows: predicates, of which p0 has the threads that run; then these, what Blend takes, registers and constants.
constexpr uint32_t kIndices = kArguments;  // thread, block, threads, blocks
constexpr uint32_t kWords = kIndices + 4;
constexpr uint32_t kBlended = kWords + kIntersectionWords;
constexpr uint32_t kOwn = kBlended + 1;

// What is done in one step, with d, a, b, c of its Code.
//   ROW(name, expression): in each lane row d becomes the expression, in rows a and b (as signed numbers sa and sb) and
//   the mode; predicate d becomes it under mask c; in the logic steps a and b are predicates. A name with an I behind
//   it is a step whose b is an immediate.
#define RAYPOOL_VALUE_STEPS(ROW)                    \
  ROW(Mov, b)                                       \
  ROW(Iadd, a + b)                                  \
  ROW(Isub, a - b)                                  \
  ROW(Imul, a* b)                                   \
  ROW(And, a& b)                                    \
  ROW(Or, a | b)                                    \
  ROW(Xor, a ^ b)                                   \
  ROW(Shl, a << (b & 31))                           \
  ROW(Shr, a >> (b & 31))                           \
  ROW(Sar, words_of(ints_of(a) >> ints_of(b & 31))) \
  ROW(Imin, chosen(words_of(sa < sb), a, b))        \
  ROW(Imax, chosen(words_of(sa > sb), a, b))        \
  ROW(Umin, chosen(words_of(a < b), a, b))          \
  ROW(Umax, chosen(words_of(a > b), a, b))          \
  ROW(Fadd, floats.add(a, b))                       \
  ROW(Fsub, floats.sub(a, b))                       \
  ROW(Fmul, floats.mul(a, b))                       \
  ROW(Fmin, floats.min(a, b))                       \
  ROW(Fmax, floats.max(a, b))                       \
  ROW(F2i, floats.to_int(a))                        \
  ROW(I2f, floats.from_int(a))                      \
  ROW(Fdiv, floats.div(a, b))                       \
  ROW(Fsqrt, floats.sqrt(a))                        \
  ROW(Frsqrt, floats.rsqrt(a))                      \
  ROW(Frcp, floats.rcp(a))
#define RAYPOOL_COMPARE_STEPS(ROW)  \
  ROW(Ieq, words_of(a == b))        \
  ROW(Ine, words_of(a != b))        \
  ROW(Ilt, words_of(sa < sb))       \
  ROW(Ile, words_of(sa <= sb))      \
  ROW(Igt, words_of(sa > sb))       \
  ROW(Ige, words_of(sa >= sb))      \
  ROW(Ult, words_of(a < b))         \
  ROW(Ule, words_of(a <= b))        \
  ROW(Ugt, words_of(a > b))         \
  ROW(Uge, words_of(a >= b))        \
  ROW(Feq, floats.equal(a, b))      \
  ROW(Fne, floats.not_equal(a, b))  \
  ROW(Flt, floats.less(a, b))       \
  ROW(Fle, floats.less_equal(a, b)) \
  ROW(Fgt, floats.less(b, a))       \
  ROW(Fge, floats.less_equal(b, a))

#define RAYPOOL_LOGIC_STEPS(ROW) \
  ROW(Pand, a& b)                \
  ROW(Por, a | b)                \
  ROW(Pxor, a ^ b)               \
  ROW(Pandn, a & ~b)

enum class Step : uint32_t {
#define RAYPOOL_ROW(name, expression) name, name##I,
  RAYPOOL_VALUE_STEPS(RAYPOOL_ROW) RAYPOOL_COMPARE_STEPS(RAYPOOL_ROW)
#undef RAYPOOL_ROW
#define RAYPOOL_ROW(name, expression) name,
      RAYPOOL_LOGIC_STEPS(RAYPOOL_ROW)
#undef RAYPOOL_ROW
          Ffma,  // d = a * b + c
  Sel,           // d = predicate c ? a : b
  Blend,         // d = a, under mask c
  Load,          // d = memory at a + immediate b, under mask c
  Store,         // memory at a + immediate b = d, under mask c
  Import,
  Export,      // under mask c
  Contribute,  // under mask c
  Unless,      // goes to step d unless a thread has mask c
  If,          // goes to step d if a thread has mask c
  Again,       // goes back to step d, the begin of loop a, which has b steps
  Exit,
};

/// The same with an immediate.
Step with_immediate(Step step) { return static_cast<Step>(static_cast<uint32_t>(step) + 1); }

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

/// Steps are executed in all lanes, and jumped over where no thread has their mask. What other threads need afterwards
/// is blended in under it.
struct FunctionRunner::Builder {
  FunctionRunner& runner;
  const Function& function;
  std::vector<uint32_t> definitions;                // [register] how many ops write it
  std::vector<uint32_t> alias;                      // [register] the row that it equals always, or 0
  std::vector<std::optional<uint32_t>> immediates;  // [register] bits that it has always
  std::vector<uint32_t> places;                     // [register] its row
  std::map<uint32_t, uint32_t> constants;           // bits -> row
  std::vector<uint32_t> label_at, loop_at;          // steps
  std::vector<std::pair<size_t, int>> jumps;
  std::optional<size_t> open;  // an Unless that leads to the next step not of its mask
  Guard open_guard, known;     // `known`: a mask that a jump has just looked at
  uint32_t work = 0;           // behind the open Unless

  static constexpr uint32_t kWorthAJump = 4, kSlow = 4;  // in steps

  Builder(FunctionRunner& made, const Function& from) : runner(made), function(from) {
    const auto count = static_cast<size_t>(function.registers);
    definitions.assign(count, 0);
    alias.assign(count, 0);
    immediates.assign(count, std::nullopt);
    places.assign(count, 0);
    label_at.assign(static_cast<size_t>(function.labels), 0);
    loop_at = label_at;
    for (const Op& op : function.ops) {
      if (op.kind == Op::Kind::Instruction && is_triple(*op.info)) step_of(op.info->opcode);
      if (op.kind != Op::Kind::Instruction) continue;
      if (const int written = effects(op).register_defined; written != kNothing) ++definitions[index(written)];
    }
    for (const Op& op : function.ops) find_alias(op);
    place_registers();
  }

  static size_t index(int number) { return static_cast<size_t>(number); }
  /// The row of what all threads have, of their indices, of a ray word.
  uint32_t row(uint32_t number) const { return runner.predicates_ + number; }

  uint32_t constant(uint32_t bits) {
    const auto [place, is_new] = constants.emplace(bits, runner.rows_ + size32(runner.constants_));
    if (is_new) runner.constants_.push_back(bits);
    return place->second;
  }

  /// The row that such an op gives whenever it is executed, or 0.
  uint32_t fixed_row(const Op& op) const {
    switch (op.info->opcode) {
      case Opcode::Arg:
        return row(op.immediate);
      case Opcode::Tid:
        return row(kIndices);
      case Opcode::Block:
        return row(kIndices + 1);
      case Opcode::Threads:
        return row(kIndices + 2);
      case Opcode::Blocks:
        return row(kIndices + 3);
      default:
        return 0;
    }
  }
  static std::optional<uint32_t> fixed_bits(const Op& op) {
    if (is(op, Opcode::Unit)) return 0;  // there is one
    if (is(op, Opcode::Mov) && op.b_is_immediate) return op.immediate;
    return std::nullopt;
  }

  // What no other op writes holds this one value wherever it is defined, so that readers can take it from where it is.
  void find_alias(const Op& op) {
    if (op.kind != Op::Kind::Instruction || op.rd == kNothing || !writes_register(*op.info)) return;
    if (definitions[index(op.rd)] != 1) return;
    alias[index(op.rd)] = fixed_row(op);
    immediates[index(op.rd)] = fixed_bits(op);
  }
  bool is_fixed(int number) const { return alias[index(number)] != 0 || immediates[index(number)]; }

  /// Few rows, which fit into the host's first cache: registers that do not live at the same time share one. One that
  /// is read before it is written has its own.
  void place_registers() {
    const size_t size = function.ops.size();
    struct Life {
      size_t first, last;
    };
    std::vector<Life> lives(places.size(), {size, 0});
    const auto touch = [&](int number, size_t op) {
      if (number == kNothing) return;
      Life& life = lives[index(number)];
      life.first = std::min(life.first, op), life.last = std::max(life.last, op);
    };
    const Liveness liveness = find_liveness(function);
    for (size_t i = 0; i < size; ++i) {
      const Effects effect = effects(function.ops[i]);
      for (const int used : effect.register_uses) touch(used, i);
      touch(effect.register_defined, i);
      liveness.registers_after[i].for_each([&](int number) { touch(number, i); });
      if (i != 0) continue;
      liveness.registers_after[i].for_each([&](int number) {
        if (number != effect.register_defined) lives[index(number)].last = size;
      });
    }
    std::vector<int> order;
    for (size_t number = 0; number < lives.size(); ++number)
      if (lives[number].first < size && !is_fixed(static_cast<int>(number))) order.push_back(static_cast<int>(number));
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return lives[index(a)].first < lives[index(b)].first; });
    std::vector<size_t> busy_until;  // [place]
    for (const int number : order) {
      const Life& life = lives[index(number)];
      size_t place = 0;
      while (place < busy_until.size() && busy_until[place] > life.first) ++place;
      if (place == busy_until.size()) busy_until.push_back(0);
      busy_until[place] = life.last;
      places[index(number)] = row(kOwn) + static_cast<uint32_t>(place);
    }
    runner.rows_ = row(kOwn) + size32(busy_until);
  }

  uint32_t value(int number) {
    if (immediates[index(number)]) return constant(*immediates[index(number)]);
    return alias[index(number)] != 0 ? alias[index(number)] : places[index(number)];
  }
  std::optional<uint32_t> immediate_b(const Op& op) const {
    return op.b_is_immediate ? std::optional<uint32_t>(op.immediate) : immediates[index(op.rb)];
  }

  void close() {
    if (open && work < kWorthAJump)
      runner.codes_.erase(runner.codes_.begin() + static_cast<std::ptrdiff_t>(*open));
    else if (open)
      runner.codes_[*open].d = size32(runner.codes_);
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
    ++work;
  }

  /// From here on steps run under this mask.
  void enter(const Guard& guard) {
    if (open && open_guard == guard) return;
    close();
    if (guard.all() || guard == known) return;
    open = runner.codes_.size();
    open_guard = guard;
    add(Step::Unless, 0, 0, 0, mask_of(guard));
    work = 0;
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
        return add(step, 0, 0, 0, mask_of(op.guard));
      default:
        break;
    }
    if (op.rd != kNothing && writes_register(*op.info) && is_fixed(op.rd)) return;
    if (is(op, Opcode::Inval)) return;
    enter(op.guard);
    if (op.info->alu() == AluType::Slw || op.info->alu() == AluType::Mem) work += kSlow;
    if (is(op, Opcode::Ld)) return add(step, value(op.rd), value(op.ra), op.immediate, mask_of(op.guard));
    if (is(op, Opcode::St)) return add(step, value(op.rb), value(op.ra), op.immediate, mask_of(op.guard));
    if (is(op, Opcode::Rst)) return copy(op, row(kWords + op.word), op.guard.all());
    computation(op, step);
  }

  /// Of an op's b to a row.
  void copy(const Op& op, uint32_t to, bool in_all_lanes) {
    const std::optional<uint32_t> bits = immediate_b(op);
    if (!in_all_lanes)
      add(Step::Blend, to, bits ? constant(*bits) : value(op.rb), 0, mask_of(op.guard));
    else if (bits)
      add(Step::MovI, to, 0, *bits, 0);
    else
      add(Step::Mov, to, 0, value(op.rb), 0);
  }

  void computation(const Op& op, Step step) {
    const bool in_all_lanes = op.fresh || op.guard.all();
    if (is(op, Opcode::Mov)) return copy(op, value(op.rd), in_all_lanes);
    const uint32_t to = in_all_lanes ? value(op.rd) : row(kBlended);
    if (is(op, Opcode::Rld) || fixed_row(op) != 0) {
      add(Step::Mov, to, 0, is(op, Opcode::Rld) ? row(kWords + op.word) : fixed_row(op), 0);
    } else if (is(op, Opcode::Unit)) {
      add(Step::MovI, to, 0, 0, 0);
    } else if (step == Step::Ffma || step == Step::Sel) {
      const std::optional<uint32_t> bits = immediate_b(op);
      const uint32_t c = step == Step::Sel ? static_cast<uint32_t>(op.px) : value(op.rc);
      add(step, to, value(op.ra), bits ? constant(*bits) : value(op.rb), c);
    } else if (!has_operand(*op.info, Operand::B)) {
      add(step, to, value(op.ra), 0, 0);
    } else {
      const std::optional<uint32_t> bits = immediate_b(op);
      add(bits ? with_immediate(step) : step, to, value(op.ra), bits ? *bits : value(op.rb), 0);
    }
    if (!in_all_lanes) add(Step::Blend, value(op.rd), to, 0, mask_of(op.guard));
  }

  // Written in all lanes: where the mask is off, 0.
  void predicate(const Op& op, Step step) {
    close();
    if (op.rd == 0) return;  // p0 is never written
    const auto to = static_cast<uint32_t>(op.rd);
    if (has_operand(*op.info, Operand::Px)) {
      add(step, to, static_cast<uint32_t>(op.px), static_cast<uint32_t>(op.rb), mask_of(op.guard));
    } else {
      const std::optional<uint32_t> bits = immediate_b(op);
      add(bits ? with_immediate(step) : step, to, value(op.ra), bits ? *bits : value(op.rb), mask_of(op.guard));
    }
  }
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

namespace {

/// The rows of a packet of threads. Their memory is kept for the next one.
class Packet {
 public:
  Packet(NativeThread* threads, size_t count) : threads_(threads), count_(count) {}

  void begin(uint32_t predicates, uint32_t size, const std::vector<uint32_t>& constants) {
    static thread_local std::vector<Row> kept;
    if (kept.size() < size + constants.size()) kept.resize(size + constants.size());
    rows_ = kept.data();
    words_ = rows_ + predicates + kWords;
    std::fill_n(rows_, predicates, filled(0));
    for (uint32_t i = 0; i < kArguments; ++i) rows_[predicates + i] = filled((*threads_->arguments)[i]);
    Row* const indices = rows_ + predicates + kIndices;
    for (size_t l = 0; l < count_; ++l) {
      rows_->lane[l] = ~0u;
      indices[0].lane[l] = threads_[l].thread, indices[1].lane[l] = threads_[l].block;
      indices[2].lane[l] = threads_[l].threads, indices[3].lane[l] = threads_[l].blocks;
    }
    std::fill(words_, rows_ + size, filled(kUndefinedWord));
    for (size_t i = 0; i < constants.size(); ++i) rows_[size + i] = filled(constants[i]);
  }
  Row* rows() const { return rows_; }

  [[gnu::always_inline]] Words mask(uint32_t mask) const {
    return (rows_[mask >> 1].lane ^ (0u - (mask & 1))) & rows_->lane;
  }
  bool any(uint32_t mask) const {
    const Words lanes = this->mask(mask);
    std::array<uint64_t, kLanes / 2> pairs;
    static_assert(sizeof pairs == sizeof lanes);
    std::memcpy(&pairs, &lanes, sizeof pairs);
    uint64_t found = 0;
    for (const uint64_t pair : pairs) found |= pair;
    return found != 0;
  }

  void import() {
    for (size_t l = 0; l < count_; ++l)
      for (size_t i = 0; i < kIntersectionWords; ++i) words_[i].lane[l] = threads_[l].input[i];
  }
  void export_rays(uint32_t mask) {
    const Words lanes = this->mask(mask);
    for (size_t l = 0; l < count_; ++l) {
      if (lanes[l] == 0) continue;
      Ray& ray = threads_[l].rays.emplace_back();
      for (size_t i = 0; i < ray.size(); ++i) ray[i] = words_[i].lane[l];
    }
    forget_words();
  }
  void contribute(uint32_t mask) {
    const Words lanes = this->mask(mask);
    for (size_t l = 0; l < count_; ++l) {
      if (lanes[l] == 0) continue;
      const auto at = [&](int number) { return words_[number].lane[l]; };
      threads_[l].frame.push_back({at(word::kPixel), {at(word::kColor), at(word::kColor + 1), at(word::kColor + 2)}});
    }
    forget_words();
  }
  void load(uint32_t to, uint32_t base, uint32_t offset, uint32_t mask) {
    const Words lanes = this->mask(mask);
    for (size_t l = 0; l < count_; ++l)
      if (lanes[l] != 0) rows_[to].lane[l] = threads_->memory->load(rows_[base].lane[l] + offset);
  }
  void store(uint32_t from, uint32_t base, uint32_t offset, uint32_t mask) {
    const Words lanes = this->mask(mask);
    for (size_t l = 0; l < count_; ++l)
      if (lanes[l] != 0) threads_->memory->store(rows_[base].lane[l] + offset, rows_[from].lane[l]);
  }

 private:
  void forget_words() { std::fill_n(words_, kIntersectionWords, filled(kUndefinedWord)); }

  NativeThread* threads_;
  size_t count_;
  Row* rows_ = nullptr;
  Row* words_ = nullptr;
};

}  // namespace

#define RAYPOOL_IN_ROWS(name, given_b, result)                      \
  case Step::name: {                                                \
    [[maybe_unused]] const Words a = rows[now.a].lane, b = given_b; \
    [[maybe_unused]] const Ints sa = ints_of(a), sb = ints_of(b);   \
    rows[now.d].lane = result;                                      \
    break;                                                          \
  }
#define RAYPOOL_VALUE(name, expression)               \
  RAYPOOL_IN_ROWS(name, rows[now.b].lane, expression) \
  RAYPOOL_IN_ROWS(name##I, Words{} + now.b, expression)
#define RAYPOOL_COMPARE(name, expression)                                  \
  RAYPOOL_IN_ROWS(name, rows[now.b].lane, (expression)&packet.mask(now.c)) \
  RAYPOOL_IN_ROWS(name##I, Words{} + now.b, (expression)&packet.mask(now.c))
#define RAYPOOL_LOGIC(name, expression) RAYPOOL_IN_ROWS(name, rows[now.b].lane, (expression)&packet.mask(now.c))

// NOLINTNEXTLINE(readability-function-size): a list
template <bool kPlain>
void FunctionRunner::run_in_mode(NativeThread* threads, size_t count) const {
  const LaneArithmetic<kPlain> floats(threads->mode);
  Packet packet(threads, count);
  packet.begin(predicates_, rows_, constants_);
  Row* const rows = packet.rows();
  uint64_t operations = 0;
  const Code* const codes = codes_.data();
  for (const Code* code = codes;; ++code) {
    const Code now = *code;
    switch (static_cast<Step>(now.code)) {
      RAYPOOL_VALUE_STEPS(RAYPOOL_VALUE)
      RAYPOOL_COMPARE_STEPS(RAYPOOL_COMPARE)
      RAYPOOL_LOGIC_STEPS(RAYPOOL_LOGIC)
      case Step::Ffma:
        rows[now.d].lane = floats.fma(rows[now.a].lane, rows[now.b].lane, rows[now.c].lane);
        break;
      case Step::Sel:
        rows[now.d].lane = chosen(rows[now.c].lane, rows[now.a].lane, rows[now.b].lane);
        break;
      case Step::Blend:
        rows[now.d].lane = chosen(packet.mask(now.c), rows[now.a].lane, rows[now.d].lane);
        break;
      case Step::Load:
        packet.load(now.d, now.a, now.b, now.c);
        break;
      case Step::Store:
        packet.store(now.d, now.a, now.b, now.c);
        break;
      case Step::Import:
        packet.import();
        break;
      case Step::Export:
        packet.export_rays(now.c);
        break;
      case Step::Contribute:
        packet.contribute(now.c);
        break;
      case Step::Unless:
        if (!packet.any(now.c)) code = codes + now.d - 1;
        break;
      case Step::If:
        if (packet.any(now.c)) code = codes + now.d - 1;
        break;
      case Step::Again:
        operations += now.b;
        if (operations > most_operations_) fail_endless(now);
        code = codes + now.d - 1;
        break;
      case Step::Exit:
        return;
    }
  }
}

void FunctionRunner::run(NativeThread* threads, size_t count) const {
  const arith::Mode& mode = threads->mode;
  const bool is_plain = mode.subnormals == Subnormals::Ieee && !mode.narrow();
  is_plain ? run_in_mode<true>(threads, count) : run_in_mode<false>(threads, count);
}

}  // namespace raypool::kernel
