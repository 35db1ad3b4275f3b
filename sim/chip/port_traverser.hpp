// A traverser at the ports of a chip (machine/chip/chip_device.hpp): beats of rays come in, packages and contributions
// go out, each ray frees its place when what it has become has left.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "chip/external_traverser.hpp"
#include "chip/ports.hpp"
#include "chip/ray_fates.hpp"
#include "chip/traverser_counts.hpp"
#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "machine/chip/chip_device.hpp"
#include "machine/common/packages.hpp"

namespace raypool::chip {

/// `static` at ports: its batches are those of the published traverser of constant speed, of rays that it
/// has read; what becomes of them leaves beat by beat.
class PortTraverser : public ExternalTraverser {
 public:
  /// `layout`: of the records that leave. `tracer` must outlive it.
  PortTraverser(RayTracer& tracer, const ChipConfiguration& chip, uint32_t units, const RecordLayout& layout);

  void start(const FrameSetup& setup) override;
  void offer(TraverserPorts& ports) override;
  void clock(const ChipOutputs& outputs, const TraverserPorts& ports, bool stalls) override;

  const TraverserCounts& counts() const override { return counts_; }
  /// Cycles until the shader's stall has lasted long enough for rays to be traced; 0: it does not stall, or there are
  /// none.
  uint64_t stall_left() const override {
    return stalled_for_ == 0 || rays_.empty() ? 0 : stall_cycles_ - stalled_for_ % stall_cycles_;
  }
  uint64_t still_for(bool stalls) const override;
  void stay(uint64_t cycles, bool stalls) override { stalled_for_ = stalls ? stalled_for_ + cycles : 0; }
  std::string describe() const override;

 private:
  struct PlacedRay {
    Ray ray;
    uint32_t place = 0;
  };
  /// It goes on; when the others of its cycle do does not matter, but it is behind all of earlier ones.
  struct Result {
    uint32_t place;
    bool shadow;
    ImportKind kind;
    Intersection record;  // as it travels; of a contribution nothing
    FrameContribution contribution;
    uint64_t number;  // rising
  };
  struct Freed {
    uint32_t place;
    bool shadow;
  };

  void read(const ChipOutputs& outputs);
  uint32_t trace(uint64_t rays);
  void trace(const PlacedRay& ray);
  ImportKind move(const ChipOutputs& outputs, const TraverserPorts& ports);
  void choose(const ChipOutputs& outputs, ImportKind put);

  RayTracer& tracer_;
  const ChipConfiguration chip_;
  std::optional<RayFates> fates_;  // of the frame
  const RecordLayout layout_;
  const uint32_t beats_;     // of a record
  const uint32_t capacity_;  // of the intersection pool, of each kind
  const uint64_t batch_, stall_cycles_;
  const uint32_t units_;

  PlacedRay coming_;
  uint32_t next_beat_in_ = 0;
  std::deque<PlacedRay> rays_;  // not traced, the oldest first
  EnumArray<ImportKind, std::deque<Result>, kImportKinds> results_;
  uint32_t waiting_ = 0;  // of these
  std::deque<Result> contributions_;
  std::deque<Freed> freed_;
  std::optional<Result> leaving_;
  uint32_t next_beat_out_ = 0;
  uint64_t number_ = 0;
  uint64_t stalled_for_ = 0;  // cycles
  TraverserCounts counts_;
};

}  // namespace raypool::chip
