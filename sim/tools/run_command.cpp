// `raypool run`: a compute kernel on one compute unit, without pools; saxpy and matmul are checked against C++.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "bits.hpp"
#include "chip/program_run.hpp"
#include "cli/engine.hpp"
#include "cli/exit_code.hpp"
#include "cli/limit_sentence.hpp"
#include "cli/progress.hpp"
#include "cli/text_file.hpp"
#include "config/unused_fields.hpp"
#include "files/output_files.hpp"
#include "files/unfinished.hpp"
#include "isa/assembler.hpp"
#include "isa/did_you_mean.hpp"
#include "kernel/compute_kernels.hpp"
#include "kernel/kernel_report.hpp"
#include "tools/commands.hpp"

namespace raypool {
namespace {

/// A program in memory with its data, ready to launch, and how to look at what it leaves.
struct Job {
  std::string title;
  Program program;
  ProgramOptions options;
  Memory memory;
  std::function<bool()> check;  ///< prints whether the results are right; empty: nothing to check
};

/// Numbers of both signs and many magnitudes, the same in every run.
float sample(uint32_t i) {
  return static_cast<float>(static_cast<int>(i * 37 % 201) - 100) / static_cast<float>(i % 13 + 3);
}

void load_program(Job& job, uint32_t bytes) {
  job.memory.grow(bytes);
  for (uint32_t i = 0; i < job.program.code.size(); ++i) {
    job.memory.store(8 * i, static_cast<uint32_t>(job.program.code[i]));
    job.memory.store(8 * i + 4, static_cast<uint32_t>(job.program.code[i] >> 32));
  }
  job.options.program_length = size32(job.program.code);
}

uint32_t first_data(const Program& program) { return (size32(program.code) * 8 + 63) / 64 * 64; }

/// Compares `expected` with the words from `address` on.
bool check_results(const Job& job, uint32_t address, const std::vector<float>& expected) {
  size_t wrong = 0;
  for (uint32_t i = 0; i < expected.size(); ++i) {
    const uint32_t got = job.memory.load(address + 4 * i);
    if (got == as_bits(expected[i])) continue;
    if (++wrong <= 5) fmt::print("  result {} is {:08x}; C++ gives {:08x}\n", i, got, as_bits(expected[i]));
  }
  fmt::print("  {} results, {} wrong\n", expected.size(), wrong);
  return wrong == 0;
}

void prepare_kernel(Job& job, const RunOptions& options, uint32_t default_n, uint32_t largest_n) {
  const uint32_t n = options.n.value_or(default_n);
  if (n < 1 || n > largest_n)
    throw InputError(fmt::format("--n is {}: {} takes a size from 1 to {}", n, options.kernel, largest_n));
  if (options.blocks != 1 || options.threads != 0 || !options.arguments.empty()) {
    throw InputError(
        fmt::format("{} sets its own blocks, threads and arguments: choose its size with --n", options.kernel));
  }
  job.title = fmt::format("{}, n = {}", options.kernel, n);
  job.program = compute_kernel_program(KernelTarget(job.options.configuration));
  check_instructions(job.program, options.kernel, job.options.configuration);
  job.options.entry = job.program.entries.at(options.kernel);
  job.options.threads = job.options.configuration.contents();
  job.options.arguments[saxpy_argument::kN] = n;
}

/// As the job's machine rounds it.
float multiply_add(const Job& job, float a, float b, float c) {
  return job.options.configuration.fma ? std::fma(a, b, c) : a * b + c;
}

void prepare_saxpy(Job& job, const RunOptions& options) {
  prepare_kernel(job, options, 1000, 1u << 24);
  const uint32_t n = job.options.arguments[saxpy_argument::kN];
  const uint32_t x = first_data(job.program);
  const uint32_t y = x + 4 * n;
  const float a = 2.7182817f;
  load_program(job, y + 4 * n);
  job.options.blocks = (n + job.options.threads - 1) / job.options.threads;
  job.options.arguments[saxpy_argument::kA] = as_bits(a);
  job.options.arguments[saxpy_argument::kX] = x;
  job.options.arguments[saxpy_argument::kY] = y;
  std::vector<float> expected;
  for (uint32_t i = 0; i < n; ++i) {
    job.memory.store(x + 4 * i, as_bits(sample(i)));
    job.memory.store(y + 4 * i, as_bits(sample(i + n)));
    expected.push_back(multiply_add(job, a, sample(i), sample(i + n)));
  }
  job.check = [&job, y, expected] { return check_results(job, y, expected); };
}

void prepare_matmul(Job& job, const RunOptions& options) {
  prepare_kernel(job, options, 24, 1024);
  const uint32_t n = job.options.arguments[matmul_argument::kN];
  const uint32_t a = first_data(job.program);
  const uint32_t b = a + 4 * n * n;
  const uint32_t c = b + 4 * n * n;
  load_program(job, c + 4 * n * n);
  job.options.blocks = (n * n + job.options.threads - 1) / job.options.threads;
  job.options.arguments[matmul_argument::kA] = a;
  job.options.arguments[matmul_argument::kB] = b;
  job.options.arguments[matmul_argument::kC] = c;
  for (uint32_t i = 0; i < n * n; ++i) {
    job.memory.store(a + 4 * i, as_bits(sample(i)));
    job.memory.store(b + 4 * i, as_bits(sample(i + 7)));
  }
  std::vector<float> expected;
  for (uint32_t row = 0; row < n; ++row) {
    for (uint32_t column = 0; column < n; ++column) {
      float sum = 0;
      for (uint32_t k = 0; k < n; ++k) sum = multiply_add(job, sample(row * n + k), sample(k * n + column + 7), sum);
      expected.push_back(sum);
    }
  }
  job.check = [&job, c, expected] { return check_results(job, c, expected); };
}

/// An integer, decimal or 0x..., or a float; as a machine word.
uint32_t parse_argument(const std::string& text) {
  const bool hexadecimal = text.compare(0, 2, "0x") == 0;
  const char* const begin = text.data() + (hexadecimal ? 2 : 0);
  const char* const end = text.data() + text.size();
  int64_t integer = 0;
  const auto [stop, error] = std::from_chars(begin, end, integer, hexadecimal ? 16 : 10);
  if (error == std::errc{} && stop == end && integer >= INT32_MIN && integer <= UINT32_MAX)
    return static_cast<uint32_t>(integer);
  float real = 0;
  const auto [real_stop, real_error] = std::from_chars(begin, end, real);
  if (!hexadecimal && real_error == std::errc{} && real_stop == end && text.find_first_of(".einf") != std::string::npos)
    return as_bits(real);
  throw InputError(
      fmt::format("argument '{}' is neither a 32-bit integer (12, -3, 0xff) nor a float (1.5, 2e3)", text));
}

struct PrintRange {
  uint32_t address, words;
};

PrintRange parse_print(const std::string& text) {
  const size_t colon = text.find(':');
  if (colon == std::string::npos)
    throw InputError(fmt::format("--print '{}' is not ADDRESS:WORDS: write for example 0x400:16", text));
  const auto number = [&](const std::string& part, const char* what) {
    const bool hexadecimal = part.compare(0, 2, "0x") == 0;
    const char* const end = part.data() + part.size();
    uint32_t value = 0;
    const auto [stop, error] = std::from_chars(part.data() + (hexadecimal ? 2 : 0), end, value, hexadecimal ? 16 : 10);
    if (error != std::errc{} || stop != end)
      throw InputError(
          fmt::format("--print '{}': the {} '{}' is not a number of 32 bits (64, 0x40)", text, what, part));
    return value;
  };
  const PrintRange range{number(text.substr(0, colon), "address"), number(text.substr(colon + 1), "number of words")};
  if (range.address % 4 != 0) throw InputError(fmt::format("--print '{}': the address must be a multiple of 4", text));
  if (range.words == 0) throw InputError(fmt::format("--print '{}': print at least one word", text));
  return range;
}

void check_in_memory(const PrintRange& range, const Memory& memory) {
  if (range.address + 4 * uint64_t{range.words} <= memory.size()) return;
  throw InputError(fmt::format("--print {}:{} goes beyond the memory of {} bytes: it has the words at 0 to {}",
                               range.address, range.words, memory.size(), memory.size() / 4 * 4 - 4));
}

void prepare_assembly(Job& job, const RunOptions& options) {
  if (!std::filesystem::exists(options.kernel)) {
    throw InputError(fmt::format(
        "there is no kernel and no file '{}'{}", options.kernel,
        did_you_mean(options.kernel, {"saxpy", "matmul"}, "use saxpy, matmul or the path of an assembly file")));
  }
  if (options.n) throw InputError("--n is for saxpy and matmul: give an assembly file its size with --arg");
  if (options.arguments.size() > kArguments)
    throw InputError(fmt::format("{} arguments: there are {}", options.arguments.size(), kArguments));
  constexpr uint32_t kLargestMemory = 1u << 30;
  job.title = options.kernel;
  job.program = assemble(read_text(options.kernel), options.kernel);
  const uint64_t code_bytes = 8 * job.program.code.size();
  if (options.memory_bytes < code_bytes || options.memory_bytes > kLargestMemory) {
    throw InputError(fmt::format("memory of {} bytes: it must hold the program's {} and at most {}",
                                 options.memory_bytes, code_bytes, kLargestMemory));
  }
  load_program(job, options.memory_bytes);
  job.options.blocks = options.blocks;
  job.options.threads = options.threads == 0 ? job.options.configuration.contents() : options.threads;
  for (size_t i = 0; i < options.arguments.size(); ++i) job.options.arguments[i] = parse_argument(options.arguments[i]);
}

void print_words(const Memory& memory, const PrintRange& range) {
  for (uint32_t i = 0; i < range.words; ++i) {
    if (i % 8 == 0) fmt::print("{}  {:08x}:", i == 0 ? "" : "\n", range.address + 4 * i);
    fmt::print(" {:08x}", memory.load(range.address + 4 * i));
  }
  fmt::print("\n");
}

void print_figures(const ProgramResult& result, const Configuration& configuration) {
  const auto count = [&](int number) { return result.counters[number]; };
  if (result.timed) fmt::print("  {} cycles\n", result.cycles);
  fmt::print("  {} warp instructions, {} thread instructions\n", count(counter::kInstructions),
             count(counter::kThreadInstructions));
  if (!result.timed) return;
  const double busy = std::max<uint64_t>(1, count(counter::kBusyCycles));
  fmt::print("  ALU   utilisation  waiting      tasks\n");
  for (int i = 0; i < kAluTypes; ++i) {
    const double unused = static_cast<double>(count(counter::kUnused + i)) / (busy * configuration.alus[i].count);
    fmt::print("    {} {:>11.1f}% {:>8.2f} {:>10}\n", kAluNames[i], 100 * (1 - unused),
               static_cast<double>(count(counter::kWaiting + i)) / busy, count(counter::kIssued + i));
  }
  fmt::print("  data cache: {} hits, {} misses, {} stores; memory: {} lines read, {} quadwords written\n",
             count(counter::kDataCacheHits), count(counter::kDataCacheMisses), count(counter::kDataCacheStores),
             result.memory_reads, result.memory_writes);
}

void prepare(Job& job, const RunOptions& options) {
  job.options.configuration = load_configuration(options.config, options.set);
  refuse_settings_of_frames(job.options.configuration);
  if (options.kernel == "saxpy") return prepare_saxpy(job, options);
  if (options.kernel == "matmul") return prepare_matmul(job, options);
  prepare_assembly(job, options);
}

ProgramResult run_job(Job& job, const RunOptions& options, ComputeUnit& unit) {
  job.options.device = &unit;
  job.options.memory = &job.memory;
  // Without a limit of the user's a program that never ends should not take an hour.
  constexpr uint64_t kDefaultCycles = 100'000'000;
  const RunLimits by_default{kDefaultCycles, RunLimits().silent()};
  job.options.limits = options.cycle_limit ? RunLimits{*options.cycle_limit, {}} : by_default;
  Progress progress(options.quiet);
  job.options.progress = [&](uint64_t cycles, uint64_t instructions) {
    if (!progress.due()) return;
    const std::string time = unit.timed() ? fmt::format("{} cycles, ", cycles) : "";
    progress.show(fmt::format("  {}{} warp instructions, {:.0f} s", time, instructions, progress.seconds()));
  };
  return run_program(job.options);
}

/// The sentence of a fault, with the address of a load or store.
std::string describe(const ChipFault& fault, const RunOptions& options) {
  Job again;
  prepare(again, options);
  const std::string access = faulting_access(again.options, again.memory, fault.fault);
  return access.empty() ? fault.what() : fmt::format("{}: {}", fault.what(), access);
}

}  // namespace

int run_command(const RunOptions& options) {
  Job job;
  const Engine engine = parse_engine(options.engine);
  std::vector<PrintRange> ranges;
  for (const std::string& text : options.print) ranges.push_back(parse_print(text));
  if (!options.waves.empty() && engine == Engine::Functional)
    throw InputError("engine functional has no waveform: use rtl or lockstep");
  if (options.inspect_until != 0 && engine != Engine::Lockstep) throw InputError("--inspect is for --engine lockstep");
  prepare(job, options);
  for (const PrintRange& range : ranges) check_in_memory(range, job.memory);

  const EngineOptions unit_options{engine, job.options.configuration, options.unit_library, !options.waves.empty(),
                                   1,      options.inspect_until};
  std::unique_ptr<ComputeUnit> unit = make_unit(unit_options, job.memory);
  OutputFiles waves;
  std::optional<KeepRunning> keep_running;
  if (!options.waves.empty()) {
    keep_running.emplace();
    unit->open_waveform(waves.begin(options.waves, true));
  }
  const auto close_waves = [&] {
    unit.reset();
    waves.publish();
  };
  // The waveform is wanted most when something goes wrong.
  const auto keep_waves = [&] {
    close_waves();
    if (!options.waves.empty()) std::fprintf(stderr, "raypool: the waveform until then is %s\n", options.waves.c_str());
  };

  ProgramResult result;
  std::string compared;
  try {
    result = run_job(job, options, *unit);
    if (const auto counts = lockstep_counts(*unit)) compared = to_string(*counts);
  } catch (const LimitPassed& passed) {
    keep_waves();
    throw InputError(limit_sentence(passed, options.cycle_limit.has_value()));
  } catch (const ChipFault& fault) {
    keep_waves();
    throw InputError(describe(fault, options));
  } catch (const std::exception&) {
    keep_waves();
    throw;
  }
  close_waves();

  fmt::print("{}: {} on {}, {} blocks of {} threads\n", job.title, options.engine, job.options.configuration.name,
             job.options.blocks, job.options.threads);
  const bool right = !job.check || job.check();
  print_figures(result, job.options.configuration);
  if (!compared.empty()) fmt::print("  {}\n", compared);
  for (const PrintRange& range : ranges) print_words(job.memory, range);
  return right ? kDone : kOtherFailure;
}

}  // namespace raypool
