// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A compute unit as a queue: its warps execute segments of kernels at one rate, which the load of what they share
// allows, and wait in between for packages.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "estimate/flow_ray.hpp"
#include "estimate/kernel_costs.hpp"
#include "machine/chip/ray_kernel.hpp"
#include "machine/compute/compute_unit.hpp"

namespace raypool::estimate {

/// How sharply warps that share a resource slow each other down: at a load of 1 by 2^(1 / kUnitSharpness). Calibrated
/// with the machines of docs/studies/estimate.md.
inline constexpr double kUnitSharpness = 5;

using KernelTable = EnumArray<RayKernel, KernelCosts, kRayKernels>;

struct Launch {
  RayKernel kernel = RayKernel::CastEye;
  ImportKind import = ImportKind::None;
  uint32_t threads = 0, warps = 0;
  uint32_t tile = 0;             ///< of cast_eye
  std::vector<FlowRay> imports;  ///< of the others, of each thread
  uint32_t received = 0;
  uint32_t warps_begun = 0;  ///< a bit each
  uint32_t warps_ended = 0;
  double taken_at = 0;
  uint32_t normal_left = 0, shadow_left = 0;  ///< rays that it may still export
  uint32_t unexported = 0;                    ///< packages that it has exported and that have not left
  bool ended = false;
};

/// What a warp has exported and has not left.
struct Export {
  Launch* launch = nullptr;
  uint32_t warp = 0;
  std::vector<FlowRay> rays;  ///< none: contributions
  uint32_t left = 0;          ///< packages
  double offered_at = 0;
};

class UnitFlow {
 public:
  /// The rays that these threads of a launch export; `reflections`: or what else.
  using Exporter = std::function<std::vector<FlowRay>(const Launch&, uint32_t first, uint32_t count, bool reflections)>;

  UnitFlow(const Configuration& configuration, const KernelTable& kernels, Exporter exporter)
      : configuration_(configuration), kernels_(kernels), exporter_(std::move(exporter)), warps_(configuration.warps) {}

  bool idle() const { return running_.empty() && waiting_ == nullptr; }
  bool executes() const { return !running_.empty(); }
  /// Another launch may wait: there is none, and its imports have been requested.
  bool ready() const { return waiting_ == nullptr && importing_.empty(); }
  uint32_t kernels() const { return static_cast<uint32_t>(running_.size()) + (waiting_ != nullptr ? 1 : 0); }
  void take(Launch& launch, double now);

  /// When a warp's segment ends, or an export is offered, unless something else happens before.
  double next() const;
  /// Time goes on; not beyond next(). Launches whose kernels end are appended.
  void advance(double now, std::vector<Launch*>& ended);

  /// The launch whose next package is asked for; null: none, or its warp still has others.
  Launch* importing(double now);
  /// When it will be asked for; kNoEvent: not by itself.
  double imports_at() const;
  /// A package of it has come.
  void imported();
  /// What is offered at a port; null: nothing.
  Export* offered(double now);
  /// So many packages of what is offered have left.
  void left(uint32_t count);

  double kernel_cycles() const { return kernel_cycles_; }
  const EnumArray<RayKernel, double, kRayKernels>& warps_of() const { return warps_of_; }

 private:
  struct Warp {
    enum class State : uint8_t { Idle, Starting, Executing, Importing, Exporting };
    State state = State::Idle;
    Launch* launch = nullptr;
    size_t segment = 0;
    double starts_at = 0;          // time, while Starting
    double ends_at = 0;            // of the segment, on the unit's clock
    const Launch* full = nullptr;  // whose packages its input slice holds
    uint32_t exporting = 0;        // packages of its output slice that have not left
  };

  const Segment& segment(const Warp& warp) const { return kernels_[warp.launch->kernel].segments[warp.segment]; }
  void begin_waiting(double now);
  bool move(uint32_t number, std::vector<Launch*>& ended);
  bool start(uint32_t number);
  void execute(Warp& warp, double more);
  void exchange(uint32_t number, std::vector<Launch*>& ended);
  void export_slice(uint32_t number);
  void set_rate();

  const Configuration& configuration_;
  const KernelTable& kernels_;
  Exporter exporter_;
  std::vector<Warp> warps_;
  std::deque<Launch*> running_;  // the older one first
  Launch* waiting_ = nullptr;
  std::deque<Launch*> importing_;
  std::deque<Export> exports_;
  double clock_ = 0, rate_ = 1, now_ = 0;
  double kernel_cycles_ = 0, last_end_ = 0;
  EnumArray<RayKernel, double, kRayKernels> warps_of_{};
};

}  // namespace raypool::estimate
