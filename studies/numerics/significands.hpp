// What floats of fewer bits do to a scene's picture: its difference from the frame in double precision.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "config/configuration.hpp"
#include "scene/native_renderer.hpp"
#include "scene/picture_file.hpp"
#include "scene/pixel_decisions.hpp"
#include "scene/scene.hpp"

namespace raypool::numerics {

struct SignificandRow {
  uint32_t significand = arith::kFullSignificand;
  PictureDifference difference;                 ///< from the frame in double precision
  std::array<uint64_t, kPixelCauses> causes{};  ///< pixels that differ, as `raypool compare` counts them
};

/// A row for each significand that there is, the full one first; all else of arithmetic and hits is the
/// configuration's. `frame` has size and depth. `progress` gets the number of rows that are done. Throws InputError as
/// render_native() does.
std::vector<SignificandRow> try_significands(const Scene& scene, const Configuration& configuration,
                                             NativeOptions frame,
                                             const std::function<void(size_t)>& progress = nullptr);

/// The smallest one with a picture that passes, as do those of all above it.
std::optional<uint32_t> smallest_passing(const std::vector<SignificandRow>& rows);

std::string significand_table(const std::vector<SignificandRow>& rows);

}  // namespace raypool::numerics
