// What floats of fewer bits do to a scene's picture.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "numerics/trade.hpp"
#include "scene/image.hpp"

namespace raypool::numerics {

/// dB of two pictures of 8 bits between which nobody sees a difference: by a root of mean squares of one step of 255.
inline constexpr double kInvisible = 48;

struct SignificandRow {
  uint32_t significand = arith::kFullSignificand;
  Quality quality;             ///< against the double-precision reference
  ImageDifference difference;  ///< of the picture from that of the full significand
};

/// A row for each significand that there is, the full one first; all else of the arithmetic is the mode's. `scene` must
/// have its reference. `progress` gets the number of rows that are done.
std::vector<SignificandRow> try_significands(const TradeScene& scene, arith::Mode mode,
                                             const std::function<void(size_t)>& progress = nullptr);

/// The smallest one that, as all above it, draws what the full one does within kInvisible.
uint32_t smallest_invisible(const std::vector<SignificandRow>& rows);

std::string significand_table(const std::vector<SignificandRow>& rows);

}  // namespace raypool::numerics
