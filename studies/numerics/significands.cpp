#include "numerics/significands.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "config/parameter_table.hpp"

namespace raypool::numerics {

std::vector<SignificandRow> try_significands(const TradeScene& scene, arith::Mode mode,
                                             const std::function<void(size_t)>& progress) {
  std::vector<SignificandRow> rows;
  std::optional<FrameBuffer> full;
  for (uint32_t significand = arith::kFullSignificand; significand >= arith::kLeastSignificand; --significand) {
    mode.significand = significand;
    const RecordedFrame drawn = record_frame(scene, mode);
    if (!full) full = drawn.frame;
    rows.push_back({significand, judge_frame(scene, drawn), compare(drawn.frame, *full)});
    if (progress) progress(rows.size());
  }
  return rows;
}

uint32_t smallest_invisible(const std::vector<SignificandRow>& rows) {
  uint32_t smallest = arith::kFullSignificand;
  for (const SignificandRow& row : rows) {
    if (row.difference.psnr < kInvisible) break;
    smallest = row.significand;
  }
  return smallest;
}

std::string significand_table(const std::vector<SignificandRow>& rows) {
  const auto decibels = [](double value) { return std::isfinite(value) ? fmt::format("{:.1f}", value) : "equal"; };
  std::string text = fmt::format("{:>4}  {:>6} {:>6} {:>8} {:>6}  {:>9}  {:>10} {:>8} {:>8}\n", "bits", "wrong",
                                 "holes", "wrong", "NaN", "dB of the", "dB of full", "pixels", "largest");
  text += fmt::format("{:>4}  {:>6} {:>6} {:>8} {:>6}  {:>9}  {:>10} {:>8} {:>8}\n", "", "hits", "", "shadows",
                      "pixels", "reference", "picture", "differ", "of 255");
  for (const auto& [significand, quality, difference] : rows) {
    text += fmt::format("{:>4}  {:>6} {:>6} {:>8} {:>6}  {:>9}  {:>10} {:>8} {:>8}\n", significand,
                        quality.wrong_triangles, quality.holes, quality.wrong_shadows, quality.nan_pixels,
                        decibels(quality.psnr), decibels(difference.psnr), difference.pixels, difference.largest);
  }
  return text + fmt::format("smallest without a visible difference from {} bits ({:.0f} dB): {} bits\n",
                            arith::kFullSignificand, kInvisible, smallest_invisible(rows));
}

}  // namespace raypool::numerics
