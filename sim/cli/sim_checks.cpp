#include "cli/sim_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "cli/frame.hpp"
#include "cli/shaders.hpp"
#include "config/configuration.hpp"
#include "config/settings.hpp"
#include "isa/did_you_mean.hpp"

namespace raypool {
namespace {

/// "2%", or "10s": a number above zero and that unit, which may be left out.
double parse_amount(const std::string& text, const char* option, const std::string& unit, double most) {
  size_t end = 0;
  double value = 0;
  try {
    value = std::stod(text, &end);
  } catch (const std::exception&) {
    end = std::string::npos;
  }
  if (end == std::string::npos || (end != text.size() && text.substr(end) != unit) || !(value > 0 && value <= most)) {
    throw InputError(
        fmt::format("{} is '{}': it must be a number above 0, at most {:g}, and {}", option, text, most, unit));
  }
  return value;
}

bool is_chosen(const SimOptions& options, const std::string& field) {
  const std::vector<std::string> set = paths_set(options.set);
  return std::find(set.begin(), set.end(), field) != set.end();
}

void check_precision(const SimOptions& options, Engine engine) {
  if ((!options.precision.empty() || options.unstable != 0) && engine != Engine::Native) {
    throw InputError(fmt::format(
        "engine {} draws with the arithmetic of its machine: use native, or leave --precision and --unstable out",
        options.engine));
  }
  if (options.unstable != 0 && (options.precision == "double" || options.hits == "embree")) {
    throw InputError(
        "--unstable moves last bits of single precision, with hits of our own: leave it out, or --precision double and "
        "--hits embree");
  }
  if (options.precision.empty()) return;
  if (options.precision != "single" && options.precision != "double") {
    throw InputError(fmt::format("--precision is '{}'{}", options.precision,
                                 did_you_mean(options.precision, {"single", "double"}, "use single or double")));
  }
  if (options.precision == "single") return;
  const std::vector<std::string> set = paths_set(options.set);
  const bool arithmetic =
      std::any_of(set.begin(), set.end(), [](const std::string& path) { return path.rfind("arithmetic.", 0) == 0; });
  if (options.hits == "embree" || !options.traverser.empty() || is_chosen(options, "chip.traverser") || arithmetic) {
    throw InputError(
        "--precision double has neither the arithmetic nor the hits of a machine: leave --hits, --traverser and --set "
        "arithmetic... out");
  }
}

/// Without an engine there is nothing that only some have.
void check_engine_open(const SimOptions& options) {
  const std::pair<const char*, bool> of_some[] = {{"--boundary", !options.boundary.empty()},
                                                  {"--hits", !options.hits.empty()},
                                                  {"--precision", !options.precision.empty()},
                                                  {"--unstable", options.unstable != 0},
                                                  {"--waves", options.waves},
                                                  {"--trace", !options.trace.empty()},
                                                  {"--modules", options.modules},
                                                  {"--inspect", options.inspect_until != 0},
                                                  {"--cycles", options.cycle_limit.has_value()}};
  for (const auto& [option, given] : of_some) {
    if (!given) continue;
    throw InputError(fmt::format(
        "{} is for an engine that has it, and {} leaves the engine open: name one with --engine, or leave {} out",
        option, options.error.empty() ? "--within" : "--error", option));
  }
  check_shaders(options, Engine::Model);
}

}  // namespace

double error_of(const SimOptions& options) {
  return options.error.empty() ? 0 : parse_amount(options.error, "--error", "%", 50) / 100;
}
double seconds_of(const SimOptions& options) {
  return options.within.empty() ? 0 : parse_amount(options.within, "--within", "s", 1e6);
}

void check_options(const SimOptions& options, Engine engine) {
  if (options.choose_engine && options.estimating == nullptr)
    throw InputError("this program has one engine with a count of cycles, model: leave --error and --within out");
  if ((engine == Engine::Sampled || engine == Engine::Estimate) && options.estimating == nullptr)
    throw InputError(fmt::format("this program has no engine {}: use another, such as model", options.engine));
  check_depth_and_units(options.depth, options.units);
  if (!options.error.empty() && !options.within.empty())
    throw InputError("--error determines the time, and --within the error: give one of them");
  if (options.choose_engine) return check_engine_open(options);
  if (!options.boundary.empty() && !has_verilog(engine)) {
    throw InputError(fmt::format(
        "engine {} has no Verilog, and so no boundary: use rtl or lockstep, or leave --boundary out", options.engine));
  }
  if (!options.hits.empty() && engine != Engine::Native) {
    throw InputError(
        fmt::format("engine {} has the hits of its traverser: use native, or leave --hits out", options.engine));
  }
  if (!options.hits.empty() && options.hits != "own" && options.hits != "embree") {
    throw InputError(fmt::format("--hits is '{}'{}", options.hits,
                                 did_you_mean(options.hits, {"own", "embree"}, "use own or embree")));
  }
  if (options.hits == "embree" && (!options.traverser.empty() || is_chosen(options, "chip.traverser")))
    throw InputError("--hits embree takes no hits of the machine's traverser: leave --traverser out");
  check_precision(options, engine);
  check_shaders(options, engine);
  if (options.waves && !has_verilog(engine)) {
    throw InputError(fmt::format("engine {} has no waveform: use rtl or lockstep, or leave waves out", options.engine));
  }
  if (options.modules && (engine == Engine::Native || engine == Engine::Estimate)) {
    throw InputError(fmt::format("engine {} has no chip, and so no modules to print: choose another, such as model",
                                 options.engine));
  }
  if (!options.trace.empty() && engine != Engine::Model) {
    throw InputError(fmt::format("engine {} leaves no trace: use model, or leave trace out", options.engine));
  }
  if (options.threads != 0 && engine != Engine::Native && engine != Engine::Estimate && engine != Engine::Sampled) {
    throw InputError(fmt::format(
        "engine {} runs on one thread: use native, estimate or sampled, or leave --threads out", options.engine));
  }
  if (options.inspect_until != 0 && engine != Engine::Lockstep) throw InputError("--inspect is for --engine lockstep");
  if (engine != Engine::Sampled && (!options.error.empty() || !options.within.empty() || options.seed != 0)) {
    throw InputError(
        fmt::format("engine {} draws no sample: use sampled, or leave --error, --within and --seed out; without "
                    "--engine, --error and --within choose the engine",
                    options.engine));
  }
  if (options.cycle_limit && engine != Engine::Model && !has_verilog(engine)) {
    throw InputError(
        fmt::format("engine {} draws without a count of cycles that could end: use model, rtl or lockstep, or leave "
                    "--cycles out",
                    options.engine));
  }
}

}  // namespace raypool
