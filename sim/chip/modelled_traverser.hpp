// A traverser with a machine inside (traverser/core.hpp, traverser/lanes.hpp): a ray enters as soon as one in flight
// has left, and leaves when its tests have been made. It keeps its place in the ray pool meanwhile, and until there is
// room for what it becomes.
//
// The machine is behind the device in time: it is clocked as far as is needed, when a ray may leave it, or when the
// device takes a turn at the memory port that both share. How early a ray can leave is known from what it has still to
// visit, so the device can run ahead until then.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "chip/traverser.hpp"
#include "enum_array.hpp"
#include "traverser/machine.hpp"
#include "traverser/tree_memory.hpp"

namespace raypool::chip {

class ModelledTraverser : public Traverser, private traverser::MemoryTurns {
 public:
  SC_HAS_PROCESS(ModelledTraverser);
  ModelledTraverser(const sc_core::sc_module_name& name, const Tracing& tracing);

  void ray_arrived() override;
  void room_made(ImportKind kind) override;
  void kernel_ended(uint32_t /*unit*/) override {}
  void catch_up(uint64_t cycle) override;
  WorkDone work_done() override;
  std::string describe() override;
  void remember(const VisitList& places) override { machine_->remember(places); }
  std::optional<TraverserWork> work() const override { return machine_->work(); }

 private:
  uint64_t turn(uint64_t cycle, uint32_t beats) override { return memory->turn(cycle, beats); }
  uint64_t line(uint64_t /*start*/, uint64_t end) override { return memory->line(end); }

  void step();
  /// Clocks the machine up to this cycle, or until a ray leaves it. True if one does.
  bool simulate(uint64_t to);
  void take_ray();
  void ray_done();
  void deliver_traced() override;
  void wake_again();

  std::unique_ptr<traverser::Machine> machine_;
  sc_core::sc_event step_;
  uint64_t now_ = 0;               // the machine's time
  std::deque<uint64_t> untaken_;   // cycles in which rays arrived that have not entered: the youngest of the pool
  PooledRays::iterator next_ray_;  // the oldest of them, if there are any
  std::vector<PooledRays::iterator> in_flight_;  // [slot of the machine]
  /// Rays that are done, and without room for what they become.
  EnumArray<ImportKind, std::deque<PooledRays::iterator>, kImportKinds> held_back_;
  VisitList visits_;
};

}  // namespace raypool::chip
