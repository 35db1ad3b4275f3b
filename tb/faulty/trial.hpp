// Is a faulty unit detected? One trial runs one fault on random programs in lockstep until something differs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "config/configuration.hpp"
#include "cosim/random_program.hpp"
#include "enum_array.hpp"

namespace raypool::faulty {

/// How a trial went.
struct Outcome {
  enum class Kind : uint8_t { Survived, Difference, Hang, Stopped, Crashed, Bench };
  Kind kind = Kind::Survived;
  uint64_t programs = 0;  ///< run, the last one detected it
  std::string by;         ///< what detected it: a machine, or a bench
  std::string text;       ///< the report
};
inline constexpr EnumArray<Outcome::Kind, std::string_view, 6> kKindNames = {
    "survived", "difference", "hang", "fault or cycle limit", "simulator stopped", "bench"};
inline std::string_view name_of(Outcome::Kind kind) { return kKindNames[kind]; }

/// Verilated units, of which an environment variable selects the fault.
struct Machine {
  Configuration configuration;
  int units = 1;
  std::string library;
};

/// Runs one program on the machine, after its fault has been selected: the outcome's kind and text.
void run_program(const Machine& machine, const RandomProgram& program, Outcome& outcome);

}  // namespace raypool::faulty
