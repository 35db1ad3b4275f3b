// Which engine draws a frame when its user says what may be afforded, a time or an error, and names no engine.
#pragma once

#include <optional>
#include <string>

#include "cli/engine.hpp"

namespace raypool {

/// What the engines with a count of cycles take for a frame, as far as it is known before they run.
struct EngineCosts {
  std::optional<double> estimate_error;  ///< as Estimates::error(); none: the frame cannot be estimated
  /// Of the frame's tiles, those that the smallest sample simulates; none: several frames add up to the picture, of
  /// which there are neither samples nor estimates.
  std::optional<double> sample_share;
  double model_seconds = 0;  ///< the whole frame, on one core
  double seconds_left = 0;
  unsigned cores = 1;
};

/// Estimate, Sampled or Model, and the reason as half a sentence.
struct EngineChoice {
  Engine engine = Engine::Model;
  std::string why;
};

/// The quickest that is off by `error`, a share of the cycles, at most. It looks at no time, so a frame has the same
/// engine on every computer.
EngineChoice engine_for_error(double error, const EngineCosts& costs);

/// The one with the least error that the time left suffices for; the quickest where it suffices for none.
EngineChoice engine_for_time(const EngineCosts& costs);

}  // namespace raypool
