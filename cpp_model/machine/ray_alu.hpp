// Time of the ray ALU with its import and export engines: rtl/ray_alu.v, cycle by cycle. The words of the local ray memory are
// the functional core's; only the beats that are exported pass through here. docs/ray-alu.md gives the rules that both sides
// follow.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "config/configuration.hpp"
#include "machine/compute_unit.hpp"

namespace raypool {

class RayAlu {
 public:
  /// A task of a warp, from its issue to its end.
  struct Task {
    enum class Kind : uint8_t { Input, Output, Read, Write, Illegal };  ///< rin; rout and rfb; rld; rst; a word above 20
    Kind kind = Kind::Input;
    bool empty = false;  ///< no lane is masked
  };
  /// A beat on its way out.
  struct OutBeat {
    bool frame = false;  ///< to the frame buffer: pixel, red, green, blue
    bool last = false;   ///< third beat of a ray
    Beat data{};
  };

  explicit RayAlu(const Configuration& configuration);

  void reset();

  Task& task(uint32_t warp) { return tasks_[warp]; }

  // Registers, as they stand in the present cycle.
  /// Whether a task granted in this cycle is taken; `arriving` as for clock().
  bool ready(int arriving) const {
    if (is(kHold)) return step_ == last_step_ && !writes(hold_set_);
    if (arriving < 0) return true;
    const Task::Kind kind = tasks_[static_cast<size_t>(arriving)].kind;
    const bool access = kind != Task::Kind::Input && kind != Task::Kind::Output;
    return !(access && (last_step_ > 0 || is(kWrite)));
  }
  /// False if clock() would change nothing: it need not be called as long as no task, no import and no beat arrives.
  bool active() const { return ((state_ & kActive) | done_ | can()) != 0; }
  uint32_t done() const { return done_; }    ///< the warp whose task is done in this cycle, as a bit
  bool wrote() const { return wrote_; }      ///< that task was an rst
  bool fault() const { return is(kFault); }  ///< ray word above 20
  uint32_t fault_warp() const { return fault_warp_; }
  bool import_active() const { return is(kImporting); }
  ImportKind import_kind() const { return import_kind_; }
  /// The valids of its ports, as namespace signal has them.
  uint32_t signals() const { return state_ & kPorts; }
  /// An import is under way, or beats wait or are still to be read.
  bool moves_rays() const { return is(kImporting | kExporting); }
  /// The beat that is offered.
  const OutBeat& beat() const { return beats_[beats_first_ & beats_mask_]; }

  /// `arriving`: the warp whose task arrives in this cycle, or -1; `import_start`: of the launch that is accepted in it. Returns
  /// the warp whose rin, rout or rfb is executed at the end of this cycle, or -1. After an rout or rfb with a mask that is not
  /// empty the caller adds its beats.
  int clock(int arriving, ImportKind import_start, const UnitInputs& inputs);
  void add_ray(const Ray& ray);
  void add_contribution(const FrameContribution& contribution);

  /// Cycles in which it was not ready().
  uint64_t unready() const { return unready_; }

  /// Which set is a warp's input, current and output.
  struct Roles {
    uint8_t input = 0, current = 1, output = 2;
  };
  const Roles& roles(uint32_t warp) const { return roles_[warp]; }
  /// Registers as the RTL names them, for reports. What belongs to a valid means something only while it is set.
  struct Registers {
    bool hold, write;
    uint32_t step, write_set, full, busy, parked_in, parked_out;
  };
  Registers registers() const { return {is(kHold), is(kWrite), step_, write_set_, full_, busy_, parked_input_, parked_output_}; }

 private:
  // The registers of a bit each are bits of one word, as most cycles only ask whether any of several is set.
  static constexpr uint32_t kPorts = signal::kImportRequest | signal::kExport | signal::kFrame;
  static constexpr uint32_t kHold = 1u << 16, kResult = 1u << 17, kResultLast = 1u << 18, kFault = 1u << 19, kWrite = 1u << 20;
  static constexpr uint32_t kSlice = 1u << 21, kNext = 1u << 22, kOrder = 1u << 23, kWaiting = 1u << 24;
  static constexpr uint32_t kImportMoves = 1u << 25, kImporting = 1u << 26, kExporting = 1u << 27;
  static constexpr uint32_t kExports = kSlice | kNext | kOrder | kWaiting;
  static constexpr uint32_t kActive = kHold | kResult | kFault | kWrite | kExports | kImportMoves;

  bool is(uint32_t flags) const { return (state_ & flags) != 0; }
  void set(uint32_t flag, bool value) { state_ = (state_ & ~flag) | (value ? flag : 0); }
  /// A beat that has come takes the port of this set.
  bool writes(uint8_t number) const { return is(kWrite) & (write_set_ == number); }
  uint32_t can() const { return (parked_input_ & full_) | (parked_output_ & ~busy_); }
  bool can_request() const {
    return (requested_ != threads_) & (outstanding_ != 2) & ((uint64_t{full_} >> (requested_ >> lane_bits_) & 1) == 0);
  }
  void settle_import() { set(kImportMoves, is(kImporting) & (is(signal::kImportRequest) | can_request())); }
  int clock_kernel(int arriving_warp, bool& read_granted);
  void execute_swap(uint32_t warp);
  void clock_import(ImportKind start, const UnitInputs& inputs);
  void clock_export(const UnitInputs& inputs, bool granted);
  void push_beat(const OutBeat& beat) { beats_[beats_end_++ & beats_mask_] = beat; }

  uint32_t state_ = 0;
  uint32_t lane_bits_ = 0, last_lane_ = 0, last_step_ = 0;
  std::vector<Task> tasks_;
  std::vector<Roles> roles_;

  // Access: rld and rst
  uint32_t step_ = 0;
  uint32_t hold_warp_ = 0;
  uint8_t hold_set_ = 0;
  bool hold_writes_ = false;
  uint32_t result_warp_ = 0;
  bool result_writes_ = false;
  uint32_t done_ = 0;
  bool wrote_ = false;
  uint32_t fault_warp_ = 0;

  uint32_t parked_input_ = 0, parked_output_ = 0;  // warps, a bit each

  // Import
  ImportKind import_kind_ = ImportKind::None;
  uint32_t threads_ = 0, requested_ = 0, received_ = 0, outstanding_ = 0, import_beat_ = 0;
  uint32_t full_ = 0;
  uint8_t write_set_ = 0;  // of the beat that came in the cycle before

  // Export
  std::vector<uint32_t> order_;  // warps in the order of their swaps, a ring
  uint32_t first_ = 0, end_ = 0;
  uint32_t busy_ = 0;
  uint32_t next_warp_ = 0;
  uint32_t slice_warp_ = 0;
  uint8_t slice_set_ = 0;
  std::vector<uint32_t> reads_;  // [warp] beats of its output slice that are left to be read
  uint32_t waiting_ = 0;         // beats that have been read, with the one that is landing
  std::vector<OutBeat> beats_;   // a ring: those that wait, and behind them those not read yet
  uint32_t beats_first_ = 0, beats_end_ = 0, beats_mask_ = 0;
  uint32_t added_ = 0;  // warp to which add_ray and add_contribution add

  uint64_t unready_ = 0;
};

}  // namespace raypool
