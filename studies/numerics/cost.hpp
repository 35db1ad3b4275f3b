// What an arithmetic mode costs: time from a run of the machine, gates from synthesis.
#pragma once

#include <filesystem>
#include <optional>

#include "numerics/extremes.hpp"
#include "numerics/trade.hpp"

namespace raypool::numerics {

/// Draws `scene`'s view at 32 x 32 on a unit of `unit`'s making, and reads cycles; its traverser is static, so
/// that they are the unit's. Nothing when the engine has no time.
std::optional<ModeTiming> time_mode(const Scene& scene, int depth, const Configuration& configuration,
                                    const UnitMaker& unit);

/// Looks through the report.json files in the folders of `synthesis` (scripts/synth leaves them in
/// build/synth/<configuration>) for the lanes of this arithmetic, whatever unit they are in: the Flt lane depends on
/// subnormal numbers and fma, the Slw lane on subnormal numbers and the slow unit. The newest report wins. Nothing
/// when a lane is in none that can be read.
std::optional<ModeGates> read_gates(const std::filesystem::path& synthesis, const arith::Mode& mode);

}  // namespace raypool::numerics
