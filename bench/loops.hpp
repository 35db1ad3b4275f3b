// What SystemC costs: a frame on the model of the chip in the bare loop (run_board) and as an assembly of SystemC
// modules (run_chip).
#pragma once

#include <string>

namespace raypool::bench {

/// Draws the frame both ways in turn, so many times each, and prints the ratio of the medians of user time. Throws
/// std::runtime_error if the cycles differ.
void compare_loops(const std::string& config, int repetitions);

}  // namespace raypool::bench
