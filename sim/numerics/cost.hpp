// What an arithmetic mode costs: time from a run of the machine, gates from synthesis.
#pragma once

#include <filesystem>
#include <optional>

#include "numerics/extremes.hpp"
#include "numerics/trade.hpp"

namespace raypool::numerics {

/// Draws `scene`'s view at 32 x 32 on a unit of `unit`'s making, and reads cycles. Nothing when the engine has no time.
std::optional<ModeTiming> time_mode(const Scene& scene, int depth, const Configuration& configuration, const UnitMaker& unit);

/// Looks through the report.json files in the folders of `synthesis` (scripts/synth leaves them in build/synth/<configuration>)
/// for one of the same warps, lanes and arithmetic, and adds up its blocks named flt_alu and slw_alu. Nothing when there is none,
/// or none that can be read.
std::optional<ModeGates> read_gates(const std::filesystem::path& synthesis, const Configuration& configuration);

}  // namespace raypool::numerics
