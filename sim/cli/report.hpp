// What a run leaves in words and numbers: report.json (docs/use/report.md) and the table on the terminal.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "chip/chip.hpp"
#include "chip/sampling.hpp"
#include "config/configuration.hpp"
#include "kernel/ray_program.hpp"
#include "lockstep/lockstep_chip.hpp"
#include "lockstep/lockstep_unit.hpp"
#include "scene/native_renderer.hpp"
#include "scene/unstable_pixels.hpp"

namespace raypool {

/// Everything a report is made from.
struct RunRecord {
  std::vector<std::string> command;  ///< the command line
  std::string engine;
  std::string engine_choice;  ///< why this engine, if its user left that open; else empty
  std::string boundary;       ///< unit or chip, of engines rtl and lockstep; else empty
  std::string hits;           ///< own or embree, of engine native; else empty
  std::string precision;      ///< single or double, of engine native; else empty
  Configuration configuration;
  std::string shaders;                        ///< folder of the shader set; empty: the built-in kernels draw
  std::shared_ptr<const RayProgram> kernels;  ///< of the shader set; null: the built-in ones
  int samples = 1;                            ///< frames whose contributions add up to the picture
  std::string scene;
  size_t triangles = 0, materials = 0;
  View view;
  int width = 0, height = 0;
  int depth = 0;
  bool reflections = false;  ///< are cast
  bool waits = false;        ///< shaders go on when their rays have come back
  /// Of the deepest rays that the chip keeps. Where shaders wait these are the rays that follow a path's first one,
  /// whatever `depth` means to them.
  int chip_depth() const { return waits ? 2 : depth; }
  int units = 0;
  std::optional<ChipResult> chip;                   ///< engines with a chip
  std::optional<NativeStatistics> native;           ///< engines native, estimate and sampled
  std::optional<UnstablePixels> unstable;           ///< engine native, if asked for
  std::optional<sampled::Figures> sampled;          ///< engine sampled
  std::optional<Estimates> estimated;               ///< engine estimate
  uint64_t seed = 0;                                ///< its
  std::optional<LockstepCounts> lockstep;           ///< engine lockstep, of the units
  std::optional<ChipLockstepCounts> chip_lockstep;  ///< or of the whole chip
  double wall_seconds = 0;                          ///< the whole run
  double simulation_seconds = 0;                    ///< drawing alone, without scene, tree and files
};

/// report.json's text.
std::string to_json(const RunRecord& record);

/// The table, several lines.
std::string to_table(const RunRecord& record);

}  // namespace raypool
