// The second run of a command after its first one met a difference.
#pragma once

#include "lockstep/lockstep_unit.hpp"

namespace raypool {

/// Runs the command again, in a process of its own, as SystemC builds a chip once in a process: with --inspect, up to
/// `difference`. True if it has met a difference again, and so printed the report with what was wrong inside; else, why
/// it has not stands on standard error.
bool run_inspecting(int argc, char** argv, const LockstepDifference& difference);

}  // namespace raypool
