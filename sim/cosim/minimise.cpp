#include "cosim/minimise.hpp"

#include <algorithm>
#include <chrono>

#include "cosim/minimise_blocks.hpp"
#include "cosim/program_check.hpp"
#include "isa/encoding.hpp"

namespace raypool {
namespace {

class Minimiser {
 public:
  Minimiser(const Configuration& configuration, RandomProgram program, const Fails& fails,
            const MinimiseOptions& options)
      : configuration_(configuration), best_(std::move(program)), fails_(fails), options_(options) {
    uint64_t executed = 0;
    check_program(configuration_, best_, ~uint64_t{0}, &executed);
    step_limit_ = 2 * executed + 1000;
  }

  RandomProgram run() {
    for (bool again = true; again && !exhausted();) {
      again = kernels();
      again |= instructions();
      again |= stalls();
      again |= threads();
      again |= restart();
      again |= rewrites();
    }
    return best_;
  }

 private:
  bool exhausted() const {
    return runs_ >= options_.attempts ||
           std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count() > options_.seconds;
  }

  bool attempt(RandomProgram program) {
    if (exhausted()) return false;
    if (!check_program(configuration_, program, step_limit_).empty()) return false;
    ++runs_;
    const bool failed = fails_(program);
    if (failed) best_ = std::move(program);
    if (options_.progress) options_.progress(best_.program.code.size(), runs_);
    return failed;
  }

  bool kernels() {
    bool any = false;
    for (size_t k = 0; k < best_.kernels.size() && best_.kernels.size() > 1;) {
      RandomProgram program = best_;
      program.kernels.erase(program.kernels.begin() + k);
      if (attempt(std::move(program)))
        any = true;
      else
        ++k;
    }
    return any;
  }

  bool instructions() {
    return minimise_blocks(
        [this] { return best_.program.code.size(); },
        [this](size_t from, size_t count) { return attempt(without_instructions(best_, from, count)); },
        [this] { return exhausted(); });
  }

  bool stalls() {
    bool any = false;
    for (size_t port = 0; port < kPorts; ++port) {
      if (best_.stalls.styles[port] == StallStyle::None) continue;
      RandomProgram program = best_;
      program.stalls.styles[port] = StallStyle::None;
      any |= attempt(std::move(program));
    }
    return any;
  }

  bool threads() {
    bool any = false;
    for (size_t k = 0; k < best_.kernels.size(); ++k) {
      for (const uint32_t threads : {1u, configuration_.lanes}) {
        if (best_.kernels[k].threads <= threads) continue;
        RandomProgram program = best_;
        program.kernels[k].threads = threads;
        any |= attempt(std::move(program));
      }
    }
    return any;
  }

  bool restart() {
    if (best_.restart == 0) return false;
    RandomProgram program = best_;
    program.restart = 0;
    return attempt(std::move(program));
  }

  bool rewrites() {
    bool any = false;
    for (size_t k = 0; k < best_.kernels.size(); ++k) {
      if (!best_.kernels[k].rewrite) continue;
      const auto without = [&](const auto& change) {
        RandomProgram program = best_;
        change(program.kernels[k].rewrite);
        const bool done = attempt(std::move(program));
        any |= done;
        return done;
      };
      if (without([](auto& rewrite) { rewrite.reset(); })) continue;
      if (best_.kernels[k].rewrite->data_seed != 0) without([](auto& rewrite) { rewrite->data_seed = 0; });
      const Rewrite whole = *best_.kernels[k].rewrite;
      for (const auto& each : whole.code) without([&](auto& rewrite) { rewrite->code.erase(each.first); });
      for (const auto& each : whole.arguments)
        if (best_.kernels[k].rewrite->arguments.size() > 1)
          without([&](auto& rewrite) { rewrite->arguments.erase(each.first); });
    }
    return any;
  }

  const Configuration& configuration_;
  RandomProgram best_;
  const Fails& fails_;
  MinimiseOptions options_;
  uint64_t step_limit_ = 0;
  uint64_t runs_ = 0;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace

RandomProgram without_instructions(const RandomProgram& program, size_t from, size_t count) {
  RandomProgram result = program;
  std::vector<uint64_t>& code = result.program.code;
  const size_t to = std::min(code.size(), from + count);
  const auto moved = [from, to](uint32_t pc) {
    return static_cast<uint32_t>(pc < from ? pc : pc < to ? from : pc - (to - from));
  };
  code.erase(code.begin() + from, code.begin() + to);
  const auto move_targets = [&](uint64_t& word) {
    const Instruction i = unpack(word);
    if (i.info == nullptr) return;
    const bool target = has_operand(*i.info, Operand::Target), end = has_operand(*i.info, Operand::End);
    if (!target && !end) return;
    // Addresses beyond the program mean "outside", not a place.
    const auto place = [&](uint32_t pc) { return pc <= program.program.code.size() ? moved(pc) : pc; };
    const uint32_t low = place(i.immediate & 0xffff),
                   high = target && end ? place(i.immediate >> 16) : i.immediate >> 16;
    word = (word & ~uint64_t{0xffffffff}) | low | high << 16;
  };
  for (uint64_t& word : code) move_targets(word);
  for (auto& [name, pc] : result.program.entries) pc = moved(pc);
  for (RandomProgram::Kernel& kernel : result.kernels) {
    kernel.pc = moved(kernel.pc);
    if (!kernel.rewrite) continue;
    std::map<uint32_t, uint64_t> rewritten;
    for (auto [pc, word] : kernel.rewrite->code) {
      if (pc >= from && pc < to) continue;
      move_targets(word);
      rewritten[moved(pc)] = word;
    }
    kernel.rewrite->code = std::move(rewritten);
  }
  fill_memory(result);
  return result;
}

RandomProgram minimise_program(const Configuration& configuration, const RandomProgram& program, const Fails& fails,
                               const MinimiseOptions& options) {
  return Minimiser(configuration, program, fails, options).run();
}

}  // namespace raypool
