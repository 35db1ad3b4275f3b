// Our own answers, from the one definition of a hit in sim/scene: that of the engines, and that of the hardware with
// every width that it can have.
#pragma once

#include "referee/contender.hpp"

namespace raypool::referee {

inline constexpr const char* kEngines = "engines, in double";
inline constexpr const char* kHardware = "hardware";
/// Significands of t that rtl/traverser/rp_triangle_pipe.v is made with; a chip has the widest.
inline constexpr uint32_t kTimeWidths[] = {26, 28, 30};

/// kEngines; the hardware's test with each of kTimeWidths; kHardware; the same, with boxes in integers of each width
/// that they can have instead of floats.
std::unique_ptr<Contender> our_answers();

/// That of kHardware.
HitAnswer hardware_answer(const HitCase& hit_case);

}  // namespace raypool::referee
