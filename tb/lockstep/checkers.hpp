// The lockstep's checkers, one an event kind. Each is told what the model did and what the RTL showed, counts what it compared,
// and throws Mismatch at the first difference. Where both sides come in their own time, each side waits in a queue for the other.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "lockstep/lockstep_unit.hpp"
#include "lockstep/mismatch.hpp"
#include "machine/compute_unit.hpp"
#include "machine/functional_core.hpp"

namespace raypool::lockstep {

/// Where an exported ray or contribution was made.
struct Origin {
  uint32_t warp, pc, lane;
};

/// Warp, PC, instruction, mask, register lanes or predicate of a retired instruction.
class RetirementChecker {
 public:
  RetirementChecker(int lanes, LockstepCounts& counts) : lanes_(lanes), counts_(&counts) {}
  /// Before the model's step: is this the instruction that the model would execute?
  void check_place(const RetireEvent& rtl, const InstructionContext& context) const;
  /// After it: has it the same result?
  void check_result(const RetireEvent& rtl, const Step& model, const InstructionContext& context);

 private:
  int lanes_;
  LockstepCounts* counts_;
};

/// Words that a `st` writes: quadwords of the store trace since the warp's last retirement against the model's lane stores,
/// merged.
class StoreChecker {
 public:
  StoreChecker(int warps, LockstepCounts& counts) : traced_(static_cast<size_t>(warps)), counts_(&counts) {}
  void traced(const StoreEvent& event);
  void check(const Step& model);
  void reset();

 private:
  std::vector<std::vector<Step::LaneStore>> traced_;  // [warp]; lane unused
  std::vector<Step::LaneStore> expected_;
  LockstepCounts* counts_;
};

/// Writes that leave through the memory port: the quadwords of the store trace, in order.
class MemoryPortChecker {
 public:
  explicit MemoryPortChecker(LockstepCounts& counts) : counts_(&counts) {}
  void traced(const StoreEvent& event);
  void written(const MemoryRequest& request);
  void check_idle() const;
  void reset() { traced_.clear(), written_.clear(); }

 private:
  void match();
  std::deque<StoreEvent> traced_;
  std::deque<MemoryRequest> written_;
  LockstepCounts* counts_;
};

/// Words that a `rst` writes to ray memory. The trace may show the lanes in one event or in several.
class RayWriteChecker {
 public:
  RayWriteChecker(int warps, int lanes, LockstepCounts& counts);
  void traced(const RayWriteEvent& event);
  void check(const Step& model, const InstructionContext& context);
  void reset();

 private:
  struct Written {
    uint32_t word = 0;
    uint32_t mask = 0;
    std::array<uint32_t, kMaxLanes> data{};
  };
  int lanes_;
  std::vector<Written> written_;  // [warp], since its last retirement
  LockstepCounts* counts_;
};

/// Import requests: kind and number are those of the launches.
class ImportChecker {
 public:
  void expect(ImportKind kind, uint32_t threads) { jobs_.push_back({kind, threads}); }
  void requested(ImportKind kind);
  void check_idle() const;
  void reset() { jobs_.clear(); }

 private:
  struct Job {
    ImportKind kind;
    uint32_t left;
  };
  std::deque<Job> jobs_;
};

/// Rays that leave through the export port, in order.
class ExportChecker {
 public:
  explicit ExportChecker(LockstepCounts& counts) : counts_(&counts) {}
  void expect(const Ray& ray, const Origin& origin);
  void beat(const Beat& data, bool last);
  void check_idle() const;
  void reset() { *this = ExportChecker(*counts_); }

 private:
  struct Expected {
    Ray ray;
    Origin origin;
  };
  void match();
  std::deque<Expected> expected_;
  std::deque<Ray> seen_;
  Ray arriving_{};
  uint32_t beats_ = 0;
  LockstepCounts* counts_;
};

/// Contributions that leave through the frame port, in order.
class FrameChecker {
 public:
  explicit FrameChecker(LockstepCounts& counts) : counts_(&counts) {}
  void expect(const FrameContribution& contribution, const Origin& origin);
  void seen(const FrameContribution& contribution);
  void check_idle() const;
  void reset() { *this = FrameChecker(*counts_); }

 private:
  struct Expected {
    FrameContribution contribution;
    Origin origin;
  };
  void match();
  std::deque<Expected> expected_;
  std::deque<FrameContribution> seen_;
  LockstepCounts* counts_;
};

/// Outputs that wait for ready stay valid and keep their payload.
class StabilityChecker {
 public:
  /// The outputs of a cycle and the inputs that answer them.
  void remember(const UnitOutputs& outputs, const UnitInputs& inputs);
  /// The outputs of the next cycle.
  void check(const UnitOutputs& outputs) const;
  void reset() { memory_ = import_ = export_ = frame_ = false; }

 private:
  bool memory_ = false, import_ = false, export_ = false, frame_ = false;  // waits
  UnitOutputs before_;
};

}  // namespace raypool::lockstep
