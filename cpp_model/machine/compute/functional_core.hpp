// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The architecture itself: registers, predicates, PC stacks, ray slices and memory of one compute unit, without ports
// and without time. step() executes one instruction of one warp and returns everything it did. Engine `functional` runs
// on it, and the lockstep compares with it.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "arith/arith.hpp"
#include "bits.hpp"
#include "config/configuration.hpp"
#include "machine/common/memory.hpp"
#include "machine/common/packages.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/compute/decoder.hpp"
#include "machine/compute/ray_slices.hpp"
#include "machine/compute/tid_alu.hpp"
#include "machine/compute/warp.hpp"

namespace raypool {

template <int kLanes>
struct Lanes;
class SpecialCensus;

inline constexpr int kMaxLanes = 32;

/// What a call of FunctionalCore::step did. Pointers stay valid until the same warp's next step.
struct Step {
  enum class Status : uint8_t {
    Executed,        ///< one instruction was executed
    WaitsForImport,  ///< nothing happened: `rin`, and the warp's packages are not there
    WaitsForExport,  ///< nothing happened: `rout` or `rfb`, and the output slice was marked busy
    NotRunning,      ///< nothing happened: the warp has not been started or has ended
    Fault,           ///< nothing happened but a fault
  };
  struct LaneStore {
    uint32_t lane, address, value;
  };

  Status status = Status::NotRunning;
  bool warp_ended = false;  ///< `exit`
  bool subnormal = false;   ///< executed, and met a subnormal number on a machine that has none: that is a fault
  uint32_t warp = 0;
  uint32_t pc = 0;
  uint32_t mask = 0;                                ///< thread mask
  uint32_t predicate = 0;                           ///< instruction writes a predicate: its value
  const DecodedInstruction* instruction = nullptr;  ///< null if the PC is outside the program
  const uint32_t* data = nullptr;       ///< instruction writes a register: one word a lane, meaningful in masked lanes
  const uint32_t* ray_words = nullptr;  ///< `rst`: one word a lane, written in masked lanes
  uint32_t store_count = 0;             ///< of stores
  uint32_t ray_count = 0;               ///< of rays
  uint32_t frame_count = 0;             ///< of frame
  Fault fault;
  // Behind what every step writes, as these are large.
  std::array<uint32_t, kMaxLanes> addresses{};  ///< `ld`, `st`: byte address of each lane, meaningful in masked lanes
  std::array<LaneStore, kMaxLanes> stores{};    ///< `st`: masked lanes in rising order; the last to an address wins
  std::array<Ray, kMaxLanes> rays{};            ///< `rout`: rays in order
  std::array<FrameContribution, kMaxLanes> frame{};  ///< `rfb`: contributions in order
};

class FunctionalCore {
 public:
  /// `memory` must outlive the core. `unit`: its number among several.
  FunctionalCore(const Configuration& configuration, Memory& memory, uint32_t unit = 0);

  /// From now on float instructions are counted in there; it must outlive the core.
  void count_specials(SpecialCensus& census) { census_ = &census, watched_ = true; }

  /// Stops everything, forgets imports, clears registers. The program is decoded at the next
  /// launch after it or after an argument.
  void reset(uint32_t program_length, uint32_t memory_limit);
  void set_argument(uint32_t index, uint32_t value) {
    tid_alu_.write_argument(index, value);
    program_decoded_ = false;
  }

  /// Starts a kernel; the previous one must have ended. Imports are announced apart, by expect_import.
  void launch(const LaunchCommand& command);
  /// Or warp by warp: before its first one the program is decoded.
  void prepare();
  /// Starts a warp, which must have ended, for its threads of the launch.
  void start(uint32_t warp, const LaunchCommand& command);
  /// True while a warp of the kernel has not executed `exit`. A fault stops a kernel without ending it.
  bool running() const { return running_warps_ > 0; }
  bool warp_running(uint32_t warp) const { return warps_[warp].running; }
  /// The launch that a warp was started for last.
  const LaunchCommand& launched(uint32_t warp) const { return warps_[warp].launch; }

  /// Executes the warp's next instruction, or the next element of a triple. After a fault every call returns that
  /// fault.
  const Step& step(uint32_t warp) { return (this->*step_)(warp); }

  /// After a fault: goes on as if nothing had happened. For a model in which faults take effect later than their
  /// instruction is executed.
  void forget_fault() { result_.status = Step::Status::NotRunning; }

  /// The instruction routine's next steps for a warp.
  PcStack::Fetch next_fetch(uint32_t warp, bool past_current) const {
    return warps_[warp].pc_stack.fetch(past_current);
  }
  /// PC of the warp's next instruction; the instruction there, null if outside the program.
  uint32_t next_pc(uint32_t warp) const { return warps_[warp].pc_stack.next_pc(); }
  const DecodedInstruction* instruction_at(uint32_t pc) const { return pc < decoded_ ? &program_[pc] : nullptr; }
  /// What step() executes next; null if the PC is outside the program.
  const DecodedInstruction* next_instruction(uint32_t warp) const {
    const DecodedInstruction* element = warps_[warp].element;
    return element != nullptr ? element : instruction_at(next_pc(warp));
  }

  /// An element of a triple has been executed, and not the last.
  bool in_triple(uint32_t warp) const { return warps_[warp].element != nullptr; }

  /// Packages of a launch with an import kind: announce their number, then give them in order of
  /// threads. Launches are served in turn.
  void expect_import(uint32_t threads) { slices_.expect_import(threads); }
  void import_package(const Intersection& package) { slices_.import_package(package); }
  void import_beat(const Beat& beat) { slices_.import_beat(beat); }
  const RaySlices& slices() const { return slices_; }

  /// While true, the warp's next `rout` or `rfb` waits. Nothing else sets or clears it.
  void set_output_busy(uint32_t warp, bool busy) { warps_[warp].output_busy = busy; }

  uint32_t warps() const { return size32(warps_); }
  uint32_t lanes() const { return lanes_; }
  const Memory& memory() const { return *memory_; }
  /// One word a lane.
  const uint32_t* register_row(uint32_t warp, uint32_t number) const {
    return &registers_[(warp * kRegisters + number) * lanes_];
  }
  uint32_t predicate(uint32_t warp, uint32_t number) const { return warps_[warp].predicates.read(number); }
  uint32_t argument(uint32_t index) const { return tid_alu_.argument(index); }
  /// Thread mask that `instruction` would have now.
  uint32_t thread_mask(uint32_t warp, const DecodedInstruction& instruction) const {
    const Warp& state = warps_[warp];
    return state.predicates.mask(state.launched, instruction.guard, instruction.guard_negated);
  }

 private:
  template <int kLanes>
  const Step& step_lanes(uint32_t warp);
  template <int kLanes>
  bool execute(const DecodedInstruction& instruction, Warp& warp, const Lanes<kLanes>& lanes);
  template <int kLanes>
  void execute_watched(const DecodedInstruction& instruction, Warp& warp, const Lanes<kLanes>& lanes);
  template <int kLanes>
  bool execute_memory(const DecodedInstruction& instruction, const Lanes<kLanes>& lanes);
  template <int kLanes>
  bool execute_ray(const DecodedInstruction& instruction, Warp& warp, const Lanes<kLanes>& lanes);
  void execute_class(const DecodedInstruction& instruction, Warp& warp, uint32_t* rd, const uint32_t* a,
                     const uint32_t* b);
  void decode_program();
  bool begin(uint32_t warp);
  bool execute_control(const DecodedInstruction& instruction, Warp& warp);
  bool fault(FaultCode code);

  Memory* memory_;
  uint32_t lanes_;
  Configuration configuration_;
  arith::Mode mode_;
  bool guarded_;  ///< against subnormal numbers
  bool watched_;  ///< floats are, by the guard or the census
  SpecialCensus* census_ = nullptr;
  uint32_t program_length_ = 0, memory_limit_ = 0;
  bool program_decoded_ = false;
  uint32_t decoded_ = 0;  ///< program_.size(), which would cost a division
  const Step& (FunctionalCore::*step_)(uint32_t) = nullptr;
  std::vector<DecodedInstruction> program_;
  std::deque<DecodedInstruction> elements_;  ///< of its triples, but for their first
  std::vector<uint32_t> registers_;          ///< [warp][register][lane]
  std::vector<Warp> warps_;
  TidAlu tid_alu_;
  RaySlices slices_;
  uint32_t running_warps_ = 0;
  Step result_;
};

}  // namespace raypool
