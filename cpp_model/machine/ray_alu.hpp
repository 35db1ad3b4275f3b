// rtl/ray_alu.v, cycle by cycle, without data: the tasks of the ray ALU, and which set is a warp's
// input, current and output. The words of the local ray memory are the functional core's.
// docs/ray-alu.md gives the rules that both sides follow.
#pragma once

#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "machine/compute_unit.hpp"
#include "machine/decoder.hpp"
#include "machine/ray_export.hpp"
#include "machine/ray_import.hpp"
#include "machine/ray_memory.hpp"

namespace raypool {

class RayAlu {
 public:
  /// A task of a warp, from its issue to its end.
  struct Task {
    Opcode opcode = Opcode::Rin;
    bool illegal = false;  ///< rld or rst of a word above 20
    uint32_t mask = 0;

    bool access() const { return opcode == Opcode::Rld || opcode == Opcode::Rst; }
  };
  /// Which set is a warp's input, current and output.
  struct Roles {
    uint8_t input = 0, current = 1, output = 2;
  };
  struct Registers {
    bool hold = false;  ///< steps of an access are left
    uint32_t step = 0;  ///< 0 while nothing is held
    uint32_t hold_warp = 0;
    uint8_t hold_set = 0;
    bool hold_write = false;
    bool result = false, result_last = false;  ///< the cycle before had a step, the last one
    uint32_t parked_in = 0, parked_out = 0;    ///< warps with a rin; with a rout or rfb
    bool done = false, trace = false;          ///< trace: the task that is done is an rst
    uint32_t done_warp = 0;
    bool fault = false;  ///< ray word above 20
    uint32_t fault_warp = 0;
  };

  /// `slices` must outlive it.
  RayAlu(const Configuration& configuration, const RaySlices& slices);

  void reset();

  /// The instruction is the warp's task, before it arrives; `illegal`: the ray word is above 20.
  void begin(uint32_t warp, const DecodedInstruction& instruction, uint32_t mask, bool illegal) {
    tasks_[warp] = {instruction.opcode, illegal, mask};
  }

  // Outputs of the present cycle.
  /// Whether a task granted in this cycle is taken; `arriving` as for clock().
  bool ready(int arriving) const {
    const bool write = import_.registers().write;
    if (q_.hold) return q_.step == last_step_ && !(write && import_.registers().write_set == q_.hold_set);
    return arriving < 0 || !(tasks_[static_cast<size_t>(arriving)].access() && (last_step_ > 0 || write));
  }
  /// False if clock() would change nothing: it need not be called as long as no task, no import and no beat arrives.
  bool active() const { return active_; }
  uint32_t done() const { return uint32_t{q_.done} << q_.done_warp; }  ///< the warp whose task is done, as a bit
  bool wrote() const { return q_.trace; }                              ///< that task was an rst
  bool fault() const { return q_.fault; }
  uint32_t fault_warp() const { return q_.fault_warp; }
  bool import_active() const { return import_.registers().active; }
  ImportKind import_kind() const { return import_.registers().request_kind; }
  /// An import is under way, or beats wait or are still to be read.
  bool moves_rays() const { return import_active() || export_.exporting(); }
  /// The valids of its ports, as namespace signal has them.
  uint32_t signals() const {
    return import_.registers().request_valid * signal::kImportRequest | export_.export_valid() * signal::kExport |
           export_.frame_valid() * signal::kFrame;
  }
  /// The beat that is offered.
  const RayExport::Beat& beat() const { return export_.offered(); }

  const Registers& registers() const { return q_; }
  const Roles& roles(uint32_t warp) const { return roles_[warp]; }
  const RayImport& import() const { return import_; }
  const RayExport& exports() const { return export_; }

  /// `arriving`: the warp whose task arrives in this cycle, or -1; `import_start`: of the launch that is accepted in
  /// it. Returns the warp whose rin, rout or rfb is executed at the end of this cycle, or -1.
  int clock(int arriving, ImportKind import_start, const UnitInputs& inputs);

 private:
  uint32_t can() const {
    return (q_.parked_in & import_.registers().full) | (q_.parked_out & ~export_.registers().busy);
  }
  bool clock_access(int arriving, RayMemory& memory);
  void clock_engines(ImportKind import_start, const UnitInputs& inputs, RayMemory& memory);
  void swap(uint32_t warp);
  void park(uint32_t warp);

  uint32_t last_step_;
  std::vector<Task> tasks_;
  std::vector<Roles> roles_;
  Registers q_;
  RayImport import_;
  RayExport export_;
  bool active_ = false;
};

}  // namespace raypool
