// A board with the chip (machine/chip/chip_device.hpp): its memory, its frame buffer, a host that starts a
// frame, and, unless the chip has one inside, the traverser at its ports. A loop over cycles, without SystemC: the chip
// has all that takes its time.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "chip/answer_watch.hpp"
#include "chip/board_memory.hpp"
#include "chip/chip.hpp"
#include "chip/external_traverser.hpp"
#include "chip/frame_figures.hpp"
#include "chip/port_traverser.hpp"
#include "chip/progress_watch.hpp"
#include "chip/tile_watch.hpp"
#include "chip/traverser_watch.hpp"
#include "isa/counters.hpp"
#include "machine/chip/chip_device.hpp"

namespace raypool {

namespace chip {

/// A frame on a board, cycle by cycle.
class Board {
 public:
  /// Starts the frame. `store`: the memories. All must outlive the board. Throws InputError for options out of range or
  /// a configuration that the chip has not, std::logic_error as ChipDevice::start_next() does.
  Board(const ChipOptions& options, ChipDevice& chip, LineStore& store, FrameBegin begin = FrameBegin::Reset);
  /// With a setup of the host's own, to which picture, depth and entries of the options must be equal.
  Board(const ChipOptions& options, const FrameSetup& setup, ChipDevice& chip, LineStore& store, FrameBegin begin);

  /// One cycle, or up to `most` in which the chip's ports are still. Returns how many.
  uint64_t clock(uint64_t most = kNever);
  /// Nothing moves any more.
  bool ended() const { return still_ >= kStillCycles; }
  /// The next frame may begin; of this one all but the ports' busy cycles has been counted.
  bool may_be_followed() const { return ended_ && chip_.outputs().ready; }
  /// The frame is drawn.
  bool drawn() const { return ended_; }
  /// Once it has ended; without the time that it took.
  ChipResult result();

 private:
  // More than any port is busy with a package: all that is counted for the report is right then.
  static constexpr uint64_t kStillCycles = 1024;

  uint64_t still_for(bool stalls) const;
  void stay(uint64_t cycles, bool stalls, uint32_t busy);
  void follow_kernels(const ChipOutputs& outputs);
  void follow_levels(const ChipOutputs& outputs);
  uint64_t next_watch() const;
  void watch();
  void count_work(const ChipOutputs& outputs);
  uint64_t due() const;
  std::string at_cycle(const std::string& what) const;
  /// What waits for what.
  std::string state() const;
  RayKernel kernel_at(uint32_t pc) const;
  /// The caches of a traverser inside hold what has been visited before this tile.
  void remember(uint32_t tile);
  void show_progress() const;
  FrameFigures figures();
  Counts counts() const;
  uint64_t counter(int number) const;
  /// Cycles in which the port serves.
  uint64_t intersection_port_busy(const ChipCounts& counts) const;
  const TraverserCounts& traced() const { return watch_ ? watch_->counts() : external_->counts(); }

  const ChipOptions& options_;
  ChipDevice& chip_;
  const FrameSetup setup_;
  BoardMemory memory_;
  AnswerWatch answers_;
  std::optional<PortTraverser> static_traverser_;
  ExternalTraverser* external_ = nullptr;  // null: it is inside
  std::optional<TraverserWatch> watch_;    // of one inside
  ChipInputs inputs_;
  uint64_t cycle_ = 0;
  uint64_t cycles_ = 0;  // of the frame, once it has ended
  bool begun_ = false, ended_ = false;
  uint64_t still_ = 0;  // cycles in which nothing has moved since the end

  // What the chip had counted before.
  ChipCounts counts_before_;
  std::array<uint64_t, counter::kCount> counters_before_{};

  KernelTimes kernels_;
  uint64_t busy_cycles_ = 0, dropped_depth_ = 0, cast_ = 0;
  LevelStatistics rays_;
  EnumArray<ImportKind, LevelStatistics, kImportKinds> intersections_;
  std::optional<TileWatch> tiles_;  // where tiles' costs are asked for
  uint64_t work_ = 0;               // transfers, and lines that the caches of a traverser inside give
  ProgressWatch progress_;
  uint64_t last_counted_, look_at_;  // cycles: the last one that counters can count; the watchdog's next one
  uint64_t watch_at_ = 0;            // of these and others the next one
};

}  // namespace chip

/// The model of the chip of `options.configuration` around these units. If they have no notion of time it changes the
/// options: no traverser needs any then, and hits come from the static one, at the ports.
std::unique_ptr<ChipDevice> make_chip_around(ChipOptions& options, std::unique_ptr<ComputeUnit> device);

/// Makes a chip of a configuration, for the program in a memory that outlives it.
using ChipMaker = std::function<std::unique_ptr<ChipDevice>(const Configuration&, Memory&)>;

/// Draws one frame on a chip for `options.configuration`. `tracer` has no meaning with a traverser inside, nor has
/// `tree` with another. Throws InputError for options out of range or a configuration that the chip has not, ChipFault,
/// TraverserFault, ChipStalled, also where an answer of the memory does not come, and whatever the chip's clock() or
/// the tracer throws.
ChipResult run_board(const ChipOptions& options, ChipDevice& chip, FrameBegin begin = FrameBegin::Reset);

}  // namespace raypool
