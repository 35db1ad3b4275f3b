#include "estimate/launch_flow.hpp"

#include <algorithm>
#include <deque>
#include <list>
#include <memory>
#include <stdexcept>
#include <utility>

#include "estimate/ray_flights.hpp"
#include "machine/chip/kernel_policy.hpp"
#include "machine/chip/launch_rules.hpp"

namespace raypool::estimate {
namespace {

// Of the tiles the first eighth fills the chip.
constexpr uint32_t kFillingShare = 8;
// Cycles from what a decision follows from to its launch; from a ray's last beat at its port until the traverser has
// it.
constexpr double kDecision = 6, kRead = 5;
constexpr double kRayBeats = 3;

double service(double overhead, double beats, bool pipelined) {
  return pipelined ? std::max(overhead, beats) : overhead + beats;
}

class LaunchFlow {
 public:
  LaunchFlow(const Configuration& configuration, uint32_t units, const Workload& work, const KernelTable& kernels)
      : chip_(configuration.chip),
        work_(work),
        ports_(configuration),
        lanes_(configuration.lanes),
        rules_(chip_, configuration.contents(), units),
        flights_(chip_, work) {
    const auto exporter = [this](const Launch& launch, uint32_t first, uint32_t count, bool reflections) {
      return exports_of(launch, first, count, reflections);
    };
    for (uint32_t i = 0; i < units; ++i) units_.emplace_back(configuration, kernels, exporter);
    policy_ =
        make_policy(chip_.policy, {configuration.contents(), units, chip_.ray_pool_size, chip_.intersection_pool_size,
                                   chip_.thresholds_rays, chip_.thresholds_intersections, chip_.static_traverser_batch,
                                   work.reflections ? 2u : 1u});
  }

  Flow run() {
    while (!finished()) {
      decide();
      step();
    }
    flow_.cycles = now_;
    flow_.in_flight = flights_.ray_cycles() / now_;
    for (const UnitFlow& unit : units_) {
      flow_.kernel_cycles += unit.kernel_cycles();
      for (size_t i = 0; i < kRayKernels; ++i) flow_.warps[i] += unit.warps_of()[i];
    }
    return std::move(flow_);
  }

 private:
  // ---- Time

  void step() {
    double next = std::min({import_ends_, import_starts_, export_ends_, put_ends_, launch_at_, stall_ends_});
    for (const UnitFlow& unit : units_) next = std::min(next, unit.next());
    if (hardware()) {
      next = std::min(next, flights_.next());
      if (!coming_.empty() && !flights_.full()) next = std::min(next, std::max(now_, coming_.front().first));
    }
    if (next == kNoEvent) throw std::logic_error("estimate: nothing is under way, and the frame is not finished");
    now_ = std::max(now_, next);
    if (import_ends_ <= now_) end_import();
    if (export_ends_ <= now_) end_export();
    if (put_ends_ <= now_) end_put();
    if (hardware()) fly();
    if (stall_ends_ <= now_) end_stall();
    for (UnitFlow& unit : units_) advance(unit);
    if (launch_at_ <= now_) take_launch();
    start_import();
    start_export();
    start_put();
    if (!hardware()) watch_stall();
  }
  bool finished() const {
    if (tiles_left() || rays_ != 0 || launch_at_ != kNoEvent || !launches_.empty()) return false;
    return std::all_of(size_.begin(), size_.end(), [](uint32_t size) { return size == 0; });
  }

  // ---- Units

  void advance(UnitFlow& unit) {
    // Contributions leave at a port of their own, which is fast enough for all.
    for (const Export* out = unit.offered(now_); out != nullptr && out->rays.empty(); out = unit.offered(now_)) {
      Launch& launch = *out->launch;
      unit.left(out->left);
      settle(launch);
    }
    std::vector<Launch*> ended;
    unit.advance(now_, ended);
    for (Launch* launch : ended) {
      settle(*launch);
      if (!hardware()) trace(chip_.static_traverser_batch);
    }
  }
  /// Where all of a kernel has left, it exports nothing more.
  void settle(Launch& launch) {
    if (!launch.ended || launch.unexported != 0) return;
    normal_to_come_ -= launch.normal_left;
    shadow_to_come_ -= launch.shadow_left;
    launches_.remove_if([&](const Launch& other) { return &other == &launch; });
  }
  std::vector<FlowRay> exports_of(const Launch& launch, uint32_t first, uint32_t count, bool reflections) {
    std::vector<FlowRay> rays;
    for (uint32_t i = first; i < first + count; ++i) {
      if (launch.kernel == RayKernel::CastEye) {
        if (i < work_.tiles[launch.tile].pixels) rays.push_back({launch.tile, 1, false});
        continue;
      }
      const FlowRay& hit = launch.imports[i];
      if (reflections)
        rays.push_back({hit.tile, static_cast<uint8_t>(hit.depth + 1), false});
      else if (chance_.happens(tile(hit).shadows))
        rays.push_back({hit.tile, static_cast<uint8_t>(kShadowDepth), false});
    }
    return rays;
  }
  const TileWork& tile(const FlowRay& ray) const { return work_.tiles[ray.tile]; }
  /// The units, from this one on.
  UnitFlow& unit(size_t from, size_t i) { return units_[(from + i) % units_.size()]; }

  // ---- Ports

  void start_import() {
    import_starts_ = kNoEvent;
    if (import_ends_ != kNoEvent) return;
    for (size_t i = 0; i < units_.size(); ++i) {
      UnitFlow& asking = unit(import_turn_, i);
      const Launch* launch = asking.importing(now_);
      if (launch == nullptr) {
        if (asking.imports_at() > now_) import_starts_ = std::min(import_starts_, asking.imports_at());
        continue;
      }
      importer_ = &asking;
      import_turn_ = (import_turn_ + i + 1) % units_.size();
      import_ends_ = now_ + ports_.intersection;
      --size_[launch->import];
      return;
    }
  }
  void end_import() {
    import_ends_ = kNoEvent;
    flow_.intersection_port += ports_.intersection;
    importer_->imported();
  }

  void start_export() {
    if (export_ends_ != kNoEvent || rays_ >= chip_.ray_pool_size) return;
    for (size_t i = 0; i < units_.size(); ++i) {
      UnitFlow& offering = unit(export_turn_, i);
      const Export* out = offering.offered(now_);
      if (out == nullptr || out->rays.empty()) continue;
      exporter_ = &offering;
      export_turn_ = (export_turn_ + i + 1) % units_.size();
      export_ends_ = now_ + ports_.ray;
      return;
    }
  }
  void end_export() {
    export_ends_ = kNoEvent;
    flow_.ray_port += ports_.ray;
    const Export& out = *exporter_->offered(now_);
    Launch& launch = *out.launch;
    const FlowRay ray = out.rays[out.rays.size() - out.left];
    --(ray.shadow() ? shadow_to_come_ : normal_to_come_);
    --(ray.shadow() ? launch.shadow_left : launch.normal_left);
    // The port drops what is too deep.
    if (ray.shadow() || ray.depth <= work_.depth) {
      ++rays_;
      shadow_rays_ += ray.shadow();
      flow_.rays += 1;
      coming_.emplace_back(now_ + kRead, ray);
    }
    exporter_->left(1);
    settle(launch);
  }

  void start_put() {
    if (put_ends_ != kNoEvent) return;
    // The oldest of those whose kind has room.
    for (auto ray = results_.begin(); ray != results_.end(); ++ray) {
      if (size_[kind_of(*ray)] >= chip_.intersection_pool_size) continue;
      putting_ = *ray;
      results_.erase(ray);
      put_ends_ = now_ + ports_.put;
      return;
    }
  }
  void end_put() {
    put_ends_ = kNoEvent;
    const ImportKind kind = kind_of(putting_);
    ++size_[kind];
    available_[kind].push_back(putting_);
    free_place(putting_);
  }
  static ImportKind kind_of(const FlowRay& ray) {
    if (ray.shadow()) return ImportKind::Shadow;
    return ray.direct ? ImportKind::Direct : ImportKind::Normal;
  }

  // ---- The traverser

  bool hardware() const { return chip_.traverser == TraverserName::Hardware; }

  void fly() {
    flights_.advance(now_);
    while (const std::optional<FlowRay> ray = flights_.take_ended()) finish_ray(*ray);
    while (!coming_.empty() && coming_.front().first <= now_ && !flights_.full()) {
      const FlowRay ray = coming_.front().second;
      coming_.pop_front();
      flow_.order.push_back({ray.tile, ray.depth});
      flights_.begin(ray, chance_);
    }
  }
  /// Of `static`: so many of the oldest rays that it has read.
  void trace(uint32_t count) {
    for (; count > 0 && !coming_.empty() && coming_.front().first <= now_; --count) {
      const FlowRay ray = coming_.front().second;
      coming_.pop_front();
      finish_ray(ray);
    }
  }
  void finish_ray(const FlowRay& ray) {
    const TileWork& work = tile(ray);
    const double goes_on = ray.shadow() ? work.lit : ray.depth == 1 ? work.eye_hits : work.reflection_hits;
    if (!chance_.happens(goes_on) || (ray.shadow() && chip_.shading == Shading::Traverser))
      free_place(ray);
    else
      results_.push_back({ray.tile, ray.depth, needs_no_reflection(ray)});
  }
  /// Of a normal ray's hit, with culling.
  bool needs_no_reflection(const FlowRay& ray) {
    return chip_.culling && work_.reflections && (ray.depth >= work_.depth || !chance_.happens(tile(ray).reflecting));
  }
  void free_place(const FlowRay& ray) {
    --rays_;
    shadow_rays_ -= ray.shadow();
  }
  /// Of `static`: while no unit has a kernel, or the ray pool is full.
  void watch_stall() {
    bool stalls = std::none_of(units_.begin(), units_.end(), [](const UnitFlow& unit) { return unit.executes(); });
    if (rays_ >= chip_.ray_pool_size && export_ends_ == kNoEvent) {
      for (UnitFlow& unit : units_) {
        const Export* out = unit.offered(now_);
        stalls |= out != nullptr && !out->rays.empty();
      }
    }
    if (!stalls)
      stall_ends_ = kNoEvent;
    else if (stall_ends_ == kNoEvent && !coming_.empty())
      stall_ends_ = now_ + chip_.static_traverser_stall_cycles;
  }
  void end_stall() {
    stall_ends_ = kNoEvent;
    trace(chip_.static_traverser_batch * size32(units_));
  }

  // ---- The controller

  bool tiles_left() const { return next_tile_ < work_.tiles.size(); }
  uint32_t available(ImportKind kind) const { return size32(available_[kind]); }
  uint32_t held() const {
    return rays_ - shadow_rays_ + available(ImportKind::Normal) + available(ImportKind::Direct) + normal_to_come_;
  }
  /// The unit that would take a launch, one without a kernel if there is one; null: none is ready.
  UnitFlow* ready_unit() {
    UnitFlow* ahead = nullptr;
    for (size_t i = 0; i < units_.size(); ++i) {
      UnitFlow& next = unit(launch_turn_, i);
      if (!next.ready()) continue;
      if (next.idle()) return &next;
      if (ahead == nullptr && chip_.launch_ahead) ahead = &next;
    }
    return ahead;
  }
  PolicyView view(bool ahead) const {
    PolicyView view;
    view.rays = rays_;
    view.normal = available(secondary_import());
    view.shadow = available(ImportKind::Shadow);
    view.rays_to_come = normal_to_come_ + shadow_to_come_;
    for (const ImportKind kind : {ImportKind::Normal, ImportKind::Shadow, ImportKind::Direct})
      view.promised += size_[kind] - available(kind);
    view.more_to_come = rays_ > 0 || view.rays_to_come > 0;
    view.secondary_room = rules_.secondary_room(shadow_rays_, shadow_to_come_, view.shadow);
    for (const UnitFlow& unit : units_) view.kernels += unit.kernels();
    view.eye_possible = tiles_left() && rules_.may_cast(work_.tiles[next_tile_].pixels, held());
    view.ahead = ahead;
    return view;
  }
  ImportKind secondary_import() const {
    return available(ImportKind::Direct) > available(ImportKind::Normal) ? ImportKind::Direct : ImportKind::Normal;
  }
  void decide() {
    if (launch_at_ != kNoEvent) return;
    const UnitFlow* ready = ready_unit();
    if (ready == nullptr) return;
    const Choice choice = policy_->choose(view(!ready->idle()));
    Launch launch;
    launch.threads = choice.threads;
    switch (choice.kind) {
      case Choice::Kind::Halt:
        return;
      case Choice::Kind::Eye:
        launch.tile = next_tile_;
        launch.threads = work_.tiles[next_tile_].threads;
        launch.normal_left = work_.tiles[next_tile_].pixels;
        break;
      case Choice::Kind::Secondary:
        launch.import = secondary_import();
        launch.kernel = work_.reflections && launch.import == ImportKind::Normal ? RayKernel::CastSecondary
                                                                                 : RayKernel::CastSecondaryDirect;
        launch.shadow_left = launch.threads;
        launch.normal_left = launch.kernel == RayKernel::CastSecondary ? launch.threads : 0;
        break;
      case Choice::Kind::Shade:
        launch.import = ImportKind::Shadow;
        launch.kernel = RayKernel::Shade;
        break;
    }
    launch.warps = (launch.threads + lanes_ - 1) / lanes_;
    next_ = std::move(launch);
    held_then_ = held();
    launch_at_ = now_ + kDecision;
  }
  void take_launch() {
    UnitFlow& taker = *ready_unit();
    launch_at_ = kNoEvent;
    launch_turn_ = static_cast<size_t>(&taker - units_.data() + 1) % units_.size();
    launches_.push_back(std::move(next_));
    Launch& launch = launches_.back();
    if (launch.kernel == RayKernel::CastEye) cast(launch.tile);
    normal_to_come_ += launch.normal_left;
    shadow_to_come_ += launch.shadow_left;
    if (launch.import != ImportKind::None) {
      std::deque<FlowRay>& from = available_[launch.import];
      launch.imports.assign(from.begin(), from.begin() + launch.threads);
      from.erase(from.begin(), from.begin() + launch.threads);
    }
    taker.take(launch, now_);
    advance(taker);
  }
  void cast(uint32_t tile) {
    rules_.cast(held_then_);
    next_tile_ = tile + 1;
    const uint32_t tiles = size32(work_.tiles), first = tiles / kFillingShare;
    if (tile == first) steady_from_ = now_;
    if (tile + 1 != tiles || tile <= first) return;
    flow_.steady_cycles = now_ - steady_from_;
    for (uint32_t i = first; i < tile; ++i) flow_.steady_rays += work_.tiles[i].rays;
  }

  const ChipConfiguration& chip_;
  const Workload& work_;
  const PortTimes ports_;
  const uint32_t lanes_;
  LaunchRules rules_;
  std::unique_ptr<KernelPolicy> policy_;
  RayFlights flights_;
  std::vector<UnitFlow> units_;

  double now_ = 0;
  double launch_at_ = kNoEvent, stall_ends_ = kNoEvent;
  double import_starts_ = kNoEvent, import_ends_ = kNoEvent, export_ends_ = kNoEvent, put_ends_ = kNoEvent;
  UnitFlow *importer_ = nullptr, *exporter_ = nullptr;
  size_t import_turn_ = 0, export_turn_ = 0, launch_turn_ = 0;
  std::list<Launch> launches_;
  Launch next_;             // decided, and taken at launch_at_
  uint32_t held_then_ = 0;  // when it was decided
  uint32_t next_tile_ = 0;
  double steady_from_ = 0;
  uint32_t rays_ = 0, shadow_rays_ = 0;                   // in the ray pool
  uint32_t normal_to_come_ = 0, shadow_to_come_ = 0;      // that kernels may still export
  std::deque<std::pair<double, FlowRay>> coming_;         // not traced; from this time on the traverser has it
  std::deque<FlowRay> results_;                           // that have not left it
  FlowRay putting_;                                       // one that is leaving
  EnumArray<ImportKind, uint32_t, kImportKinds> size_{};  // of the intersection pool
  EnumArray<ImportKind, std::deque<FlowRay>, kImportKinds> available_;  // in it, and not promised to a launch
  Chance chance_;
  Flow flow_;
};

}  // namespace

PortTimes::PortTimes(const Configuration& configuration) : put(configuration.intersection_beats()) {
  const ChipConfiguration& chip = configuration.chip;
  ray = service(chip.ray_pool_overhead, kRayBeats * chip.ray_pool_cycles_per_beat, chip.ray_pool_pipelined);
  intersection = service(chip.intersection_pool_overhead, put * chip.intersection_pool_cycles_per_beat,
                         chip.intersection_pool_pipelined);
}

Flow flow_of(const Configuration& configuration, uint32_t units, const Workload& work, const KernelTable& kernels) {
  return LaunchFlow(configuration, units, work, kernels).run();
}

}  // namespace raypool::estimate
