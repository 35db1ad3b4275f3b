// What an arithmetic mode does to a picture, counted against the double-precision reference.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "numerics/modes.hpp"
#include "numerics/reference.hpp"
#include "scene/image.hpp"
#include "scene/native_renderer.hpp"
#include "scene/scene.hpp"
#include "scene/traversal.hpp"

namespace raypool::numerics {

/// A frame with all that is made from its scene once and used in every mode.
struct TradeScene {
  /// Throws InputError as build_memory() does.
  TradeScene(std::string title, Scene scene, int width, int height, int depth);
  TradeScene(const TradeScene&) = delete;
  TradeScene& operator=(const TradeScene&) = delete;

  std::string title;
  Scene scene;
  int width, height, depth;
  MemoryImage image;
  Tracer tracer;
  ReferenceTracer reference_tracer;
  std::array<uint32_t, kArguments> arguments;
  PathImage reference;  ///< empty until draw_reference()

  void draw_reference(const std::function<void(double)>& progress = nullptr);
};

/// What the machine draws, with the paths of its rays.
struct RecordedFrame {
  RecordedFrame(int width, int height, int depth);

  FrameBuffer frame;
  PathImage paths;                  ///< colours empty: they are in `frame`
  std::vector<Ray> shadow_rays;     ///< [pixel] of the primary hit; all words zero where there is none
  std::vector<uint8_t> nan_pixels;  ///< [pixel] 1: a contribution had a NaN; a byte each, for threads
};

/// The frame by engine native; pictures of all engines are the same, bit for bit.
/// `kernel` replaces run_native, for tests; then on one thread, else on all.
RecordedFrame record_frame(const TradeScene& scene, const arith::Mode& mode,
                           const std::function<void(RayKernel, NativeThread&)>& kernel = nullptr);

/// Counts of pixels, but for the decibels.
struct Quality {
  uint64_t pixels = 0;
  uint64_t ties = 0;  ///< primary hits and shadows that differ within single precision; wrong nowhere below
  uint64_t wrong_triangles =
      0;               ///< the primary ray hits another triangle than the reference's, or one where there is none
  uint64_t holes = 0;  ///< the primary ray hits nothing where the reference hits
  uint64_t wrong_shadows = 0;  ///< at the same primary hit: light or shadow where the reference has the other
  uint64_t nan_pixels = 0;     ///< a contribution had a NaN
  uint64_t same_paths = 0;     ///< every hit and shadow as in the reference
  double psnr = 0;             ///< of linear values before they become 8 bits, peak 1, dB; infinity when equal
  double psnr_same_paths = 0;  ///< over the pixels of the same paths: what arithmetic alone does to the colours
  uint64_t off_by_one = 0;     ///< largest 8-bit difference of the three channels is 1
  uint64_t off_by_more = 0;    ///< kOffByMore or more
};
Quality judge_frame(const TradeScene& scene, const RecordedFrame& drawn);

/// A timed run of one mode.
struct ModeTiming {
  double cycles_per_ray = 0;
  double mrays_per_s = 0;
};
/// Size of one lane of the Flt and one of the Slw ALU of a mode, thousand gate equivalents, from synthesis.
struct ModeGates {
  double flt_kge = 0, slw_kge = 0;
  double total() const { return flt_kge + slw_kge; }
};

struct TradeRow {
  std::string scene;
  ArithmeticMode mode;
  Quality quality;
};
struct TradeCost {
  ArithmeticMode mode;
  std::optional<ModeTiming> timing;
  std::optional<ModeGates> gates;
};
struct TradeResult {
  std::string configuration;  ///< the base: its timing and gates are in `costs`
  std::vector<TradeRow> rows;
  std::vector<TradeCost> costs;  ///< one a mode
};

}  // namespace raypool::numerics
