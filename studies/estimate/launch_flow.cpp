#include "estimate/launch_flow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <vector>

#include "machine/chip/controller.hpp"
#include "machine/chip/kernel_policy.hpp"
#include "machine/chip/launch_rules.hpp"
#include "machine/chip/pool_levels.hpp"

namespace raypool::estimate {
namespace {

constexpr double kNoEvent = std::numeric_limits<double>::infinity();
constexpr uint8_t kShadow = kShadowDepth;

struct FlowRay {
  uint32_t tile;
  uint8_t depth;
  bool direct = false;  // its hit needs no reflection
  bool shadow() const { return depth == kShadow; }
};

// From a launch that is taken to its first instruction's issue, and to its first request.
const double kStart = getenv("KS") ? atof(getenv("KS")) : 8, kImportStart = getenv("KI") ? atof(getenv("KI")) : 5;
// Of the tiles that are cast, this share fills the chip.
constexpr uint32_t kFilling = 8;
const double kFlight = getenv("TF") ? atof(getenv("TF")) : 115;
const double kNode = getenv("TN") ? atof(getenv("TN")) : 21, kTriangle = getenv("TT") ? atof(getenv("TT")) : 5;
const double kMiss = getenv("TM") ? atof(getenv("TM")) : 20;
const double kVariety = getenv("TV") ? atof(getenv("TV")) : 3;
const double kFlightSharpness = getenv("TQ") ? atof(getenv("TQ")) : 4;
const double kWaiting = getenv("TW") ? atof(getenv("TW")) : 1.35;
const double kUsedMshrs = getenv("TU") ? atof(getenv("TU")) : 0.85;
constexpr double kLineBeats = 4;
const double kDecide = getenv("KD") ? atof(getenv("KD")) : 6;
const double kFilled = getenv("KF") ? atof(getenv("KF")) : 3;
const double kRead = getenv("KR") ? atof(getenv("KR")) : 5;
// From a swap to the first beat that is offered; beats of an import until a warp goes on.
constexpr double kExportStart = 5;
// How sharply warps that share a resource begin to slow each other down: at a load of 1 by 2^(1 / kSharpness).
const double kSharpness = getenv("KQ") ? atof(getenv("KQ")) : 4;

struct Launch {
  RayKernel kernel = RayKernel::CastEye;
  ImportKind import = ImportKind::None;
  uint32_t threads = 0, warps = 0;
  std::vector<FlowRay> imports;  // what each thread imports
  uint32_t tile = 0;             // of an eye kernel
  uint32_t requested = 0, received = 0;
  uint32_t warps_begun = 0;  // a bit each
  uint32_t warps_ended = 0;
  double normal_left = 0, shadow_left = 0;  // rays that it may still export
  uint32_t unexported = 0;                  // packages that are exported and have not left
  bool ended = false;
  double taken_at = 0;
};
using LaunchList = std::list<Launch>;

struct Warp {
  enum class State : uint8_t { Idle, Executing, Importing, Exporting };
  State state = State::Idle;
  Launch* launch = nullptr;
  size_t segment = 0;
  double ends_at = 0;            // of its segment, by the unit's own clock
  double starts_at = kNoEvent;   // time; before it the warp does not execute
  const Launch* full = nullptr;  // whose packages its input slice holds
  uint32_t exporting = 0;        // packages of its output slice that have not left
};

struct Export {
  Launch* launch;
  uint32_t warp;
  std::vector<FlowRay> rays;  // empty of contributions
  uint32_t left;
  double offered_at;
};

struct Unit {
  std::vector<Warp> warps;
  std::deque<Launch*> running;  // the older one first
  Launch* waiting = nullptr;
  std::deque<Launch*> importing;
  std::deque<Export> exports;
  double clock = 0, rate = 1, at = 0;  // warps execute `rate` of a cycle in each, since `at`
};

class LaunchFlow {
 public:
  LaunchFlow(const Configuration& configuration, uint32_t units, const Workload& work,
             const EnumArray<RayKernel, KernelCosts, kRayKernels>& kernels)
      : configuration_(configuration),
        chip_(configuration.chip),
        work_(work),
        kernels_(kernels),
        contents_(configuration.contents()),
        rules_(chip_, contents_, units),
        units_(units) {
    for (Unit& unit : units_) unit.warps.resize(configuration.warps);
    const PolicySetup setup{contents_,
                            units,
                            chip_.ray_pool_size,
                            chip_.intersection_pool_size,
                            chip_.thresholds_rays,
                            chip_.thresholds_intersections,
                            chip_.static_traverser_batch,
                            work.reflections ? 2u : 1u};
    policy_ = make_policy(chip_.policy, setup);
    const double ray_beats = 3.0 * chip_.ray_pool_cycles_per_beat;
    const double hit_beats =
        static_cast<double>(configuration.intersection_beats()) * chip_.intersection_pool_cycles_per_beat;
    const auto service = [](double overhead, double beats, bool pipelined) {
      return pipelined ? std::max(overhead, beats) : overhead + beats;
    };
    export_service_ = service(chip_.ray_pool_overhead, ray_beats, chip_.ray_pool_pipelined);
    import_service_ = service(chip_.intersection_pool_overhead, hit_beats, chip_.intersection_pool_pipelined);
    put_service_ = configuration.intersection_beats();
  }

  Flow run() {
    while (!finished()) {
      decide();
      step();
    }
    flow_.cycles = now_ + Controller::kCycles + 1;
    flow_.in_flight /= flow_.cycles;
    return flow_;
  }

 private:
  // Time.

  void step() {
    double next = kNoEvent;
    for (const Unit& unit : units_)
      next = std::min({next, next_of(unit),
                       unit.exports.empty()                     ? kNoEvent
                       : unit.exports.front().offered_at > now_ ? unit.exports.front().offered_at
                                                                : kNoEvent});
    for (const double event :
         {import_ends_, export_ends_, put_ends_, launch_at_, stall_ends_, import_starts_, ray_ends()})
      next = std::min(next, event);
    if (next == kNoEvent) {
      std::string w;
      for (auto& u : units_)
        w += fmt::format("[run {} wait {} imp {} exp {}]", u.running.size(), u.waiting != nullptr, u.importing.size(),
                         u.exports.size());
      throw std::logic_error(
          fmt::format("estimate: halt now {} rays {} shadow {} untraced {} results {} n {} s {} an {} as {} left {} "
                      "ntc {} stc {} launches {} {}",
                      now_, rays_, shadow_rays_, untraced_.size(), results_.size(), size_[ImportKind::Normal],
                      size_[ImportKind::Shadow], available_[ImportKind::Normal], available_[ImportKind::Shadow],
                      tiles_left(), normal_to_come_, shadow_to_come_, launches_.size(), w));
    }
    now_ = std::max(now_, next);
    if (import_ends_ <= now_) end_import();
    if (export_ends_ <= now_) end_export();
    if (put_ends_ <= now_) end_put();
    fly();
    if (stall_ends_ <= now_) {
      trace(chip_.static_traverser_batch * static_cast<uint32_t>(units_.size()));
      stall_ends_ = kNoEvent;
    }
    for (Unit& unit : units_) {
      contribute(unit);
      advance(unit);
    }
    if (launch_at_ <= now_) take_launch();
    start_import();
    start_export();
    start_put();
    watch_stall();
  }

  // Units.

  double next_of(const Unit& unit) const {
    double next = kNoEvent;
    for (const Warp& warp : unit.warps) {
      if (warp.state != Warp::State::Executing) continue;
      if (warp.starts_at > unit.at)
        next = std::min(next, warp.starts_at);
      else
        next = std::min(next, unit.at + std::max(0.0, warp.ends_at - unit.clock) / unit.rate);
    }
    return next;
  }
  const Segment& segment(const Warp& warp) const { return kernels_[warp.launch->kernel].segments[warp.segment]; }

  /// To now: segments that have ended are followed by what comes next.
  void advance(Unit& unit) {
    unit.clock += (now_ - unit.at) * unit.rate;
    unit.at = now_;
    bool again = true;
    while (again) {
      again = false;
      for (uint32_t w = 0; w < unit.warps.size(); ++w) {
        Warp& warp = unit.warps[w];
        if (warp.state == Warp::State::Executing && warp.starts_at <= now_ && !warp_started(unit, warp)) continue;
        again |= move(unit, w);
      }
    }
    set_rate(unit);
  }
  /// True when its segment is over.
  bool warp_started(Unit& unit, Warp& warp) const {
    if (warp.ends_at < 0) warp.ends_at = unit.clock + segment(warp).serial;  // begins now
    return warp.ends_at <= unit.clock + 1e-6;
  }

  /// True if the warp went on.
  bool move(Unit& unit, uint32_t w) {
    Warp& warp = unit.warps[w];
    switch (warp.state) {
      case Warp::State::Idle:
        return start(unit, w);
      case Warp::State::Executing:
        if (warp.starts_at > now_) return false;
        return exchange(unit, w);
      case Warp::State::Importing:
        if (warp.full != warp.launch) return false;
        warp.full = nullptr;
        next_segment(unit, warp);
        warp.ends_at += kFilled;
        return true;
      case Warp::State::Exporting:
        if (warp.exporting != 0) return false;
        export_slice(unit, w);
        next_segment(unit, warp);
        return true;
    }
    return false;
  }
  void next_segment(const Unit& unit, Warp& warp) const {
    ++warp.segment;
    warp.state = Warp::State::Executing;
    warp.ends_at = unit.clock + segment(warp).serial;
  }
  bool exchange(Unit& unit, uint32_t w) {
    Warp& warp = unit.warps[w];
    switch (kernels_[warp.launch->kernel].exchanges[warp.segment]) {
      case Exchange::Import:
        warp.state = Warp::State::Importing;
        return true;
      case Exchange::ExportRays:
      case Exchange::Contribute:
        warp.state = Warp::State::Exporting;
        return true;
      case Exchange::End:
        break;
    }
    warp.state = Warp::State::Idle;
    Launch* launch = warp.launch;
    warp.launch = nullptr;
    if (++launch->warps_ended == launch->warps) end_kernel(unit, *launch);
    return true;
  }
  /// The next launch's threads of this warp, if they may begin.
  bool start(Unit& unit, uint32_t w) {
    Warp& warp = unit.warps[w];
    for (Launch* launch : unit.running) {
      if (w >= launch->warps || started(*launch, w)) continue;
      if (launch != unit.running.front() && w < unit.running.front()->warps &&
          !ended_in(*unit.running.front(), unit, w))
        return false;
      warp.launch = launch;
      warp.segment = 0;
      warp.state = Warp::State::Executing;
      warp.starts_at = std::max(now_, launch->taken_at + kStart);
      warp.ends_at = -1;
      launch->warps_begun |= 1u << w;
      flow_.warps[launch->kernel] += 1;
      if (warp.starts_at <= now_) warp.ends_at = unit.clock + segment(warp).serial;
      return true;
    }
    return false;
  }
  static bool started(const Launch& launch, uint32_t w) { return (launch.warps_begun >> w & 1) != 0; }
  static bool ended_in(const Launch& launch, const Unit& unit, uint32_t w) {
    return started(launch, w) && unit.warps[w].launch != &launch;
  }

  /// As the load of what they share allows.
  void set_rate(Unit& unit) const {
    double issue = 0;
    EnumArray<AluType, double, kAluTypes> alus{};
    for (const Warp& warp : unit.warps) {
      if (warp.state != Warp::State::Executing || warp.starts_at > now_) continue;
      const Segment& part = segment(warp);
      if (part.serial == 0) continue;
      issue += part.instructions / part.serial;
      for (size_t type = 0; type < kAluTypes; ++type) alus[type] += part.busy[type] / part.serial;
    }
    double sum = std::pow(issue, kSharpness);
    for (size_t type = 0; type < kAluTypes; ++type)
      sum += std::pow(alus[type] / configuration_.alus[type].count, kSharpness);
    unit.rate = std::pow(1 + sum, -1 / kSharpness);
  }

  void end_kernel(Unit& unit, Launch& launch) {
    launch.ended = true;
    flow_.kernel_cycles += now_ - std::max(launch.taken_at, last_end_[&unit - units_.data()]);
    last_end_[&unit - units_.data()] = now_;
    unit.running.erase(std::find(unit.running.begin(), unit.running.end(), &launch));
    settle(launch);
    begin_waiting(unit);
    if (!hardware()) trace(chip_.static_traverser_batch);
  }
  /// All of it has left: it exports nothing more.
  void settle(Launch& launch) {
    if (!launch.ended || launch.unexported != 0) return;
    normal_to_come_ -= launch.normal_left;
    shadow_to_come_ -= launch.shadow_left;
    launches_.remove_if([&](const Launch& other) { return &other == &launch; });
  }
  void begin_waiting(Unit& unit) {
    const size_t most = configuration_.kernel_overlap ? 2 : 1;
    if (unit.waiting == nullptr || unit.running.size() >= most) return;
    unit.running.push_back(unit.waiting);
    unit.waiting->taken_at = std::max(unit.waiting->taken_at, now_ - kStart + 1);
    unit.waiting = nullptr;
  }

  void export_slice(Unit& unit, uint32_t w) {
    Warp& warp = unit.warps[w];
    Launch& launch = *warp.launch;
    const uint32_t first = w * configuration_.lanes;
    const uint32_t lanes = std::min(configuration_.lanes, launch.threads - first);
    const bool contributes = kernels_[launch.kernel].exchanges[warp.segment] == Exchange::Contribute;
    Export out{&launch, w, {}, 0, now_ + kExportStart};
    if (contributes) {
      out.left = lanes;
    } else {
      const bool reflection = launch.kernel == RayKernel::CastSecondary && !exported_reflection(warp);
      for (uint32_t i = first; i < first + lanes; ++i) {
        if (launch.kernel == RayKernel::CastEye) {
          if (i < work_.tiles[launch.tile].pixels) out.rays.push_back({launch.tile, 1});
          continue;
        }
        const FlowRay hit = launch.imports[i];
        if (reflection)
          out.rays.push_back({hit.tile, static_cast<uint8_t>(hit.depth + 1)});
        else if (happens(tile(hit).shadows))
          out.rays.push_back({hit.tile, kShadow});
      }
      out.left = static_cast<uint32_t>(out.rays.size());
    }
    if (out.left == 0) return;
    warp.exporting = out.left;
    launch.unexported += out.left;
    unit.exports.push_back(std::move(out));
  }
  /// Of the two exports of cast_secondary the first one is that of reflections.
  bool exported_reflection(const Warp& warp) const {
    const std::vector<Exchange>& exchanges = kernels_[warp.launch->kernel].exchanges;
    return std::count(exchanges.begin(), exchanges.begin() + static_cast<std::ptrdiff_t>(warp.segment),
                      Exchange::ExportRays) != 0;
  }

  // Ports.

  /// Something that comes to pass in this share of the cases.
  bool happens(double share) { return share >= 1 || std::uniform_real_distribution<double>()(random_) < share; }
  const TileWork& tile(const FlowRay& ray) const { return work_.tiles[ray.tile]; }

  void start_import() {
    import_starts_ = kNoEvent;
    if (import_ends_ != kNoEvent) return;
    for (size_t i = 0; i < units_.size(); ++i) {
      Unit& unit = units_[(import_turn_ + i) % units_.size()];
      if (unit.importing.empty()) continue;
      Launch& launch = *unit.importing.front();
      const uint32_t w = launch.requested / configuration_.lanes;
      if (unit.warps[w].full != nullptr) continue;
      if (launch.taken_at + kImportStart > now_) {
        import_starts_ = std::min(import_starts_, launch.taken_at + kImportStart);
        continue;
      }
      importer_ = &unit;
      import_turn_ = (import_turn_ + i + 1) % units_.size();
      import_ends_ = now_ + import_service_;
      --size_[launch.import];
      return;
    }
  }
  void end_import() {
    flow_.intersection_port += import_service_;
    Launch& launch = *importer_->importing.front();
    import_ends_ = kNoEvent;
    ++launch.requested;
    ++launch.received;
    if (launch.received % configuration_.lanes == 0 || launch.received == launch.threads)
      importer_->warps[(launch.received - 1) / configuration_.lanes].full = &launch;
    if (launch.received == launch.threads) importer_->importing.pop_front();
  }

  /// Contributions leave at a port of their own, which is fast enough for all.
  void contribute(Unit& unit) {
    while (!unit.exports.empty() && unit.exports.front().rays.empty() && unit.exports.front().offered_at <= now_)
      end_exports(unit, unit.exports.front().left);
  }
  void start_export() {
    if (export_ends_ != kNoEvent) return;
    for (size_t i = 0; i < units_.size(); ++i) {
      Unit& unit = units_[(export_turn_ + i) % units_.size()];
      if (unit.exports.empty() || unit.exports.front().offered_at > now_) continue;
      Export& front = unit.exports.front();
      if (front.rays.empty()) continue;
      if (rays_ >= chip_.ray_pool_size) return;
      exporter_ = &unit;
      export_turn_ = (export_turn_ + i + 1) % units_.size();
      export_ends_ = now_ + export_service_;
      return;
    }
  }
  void end_export() {
    flow_.ray_port += export_service_;
    export_ends_ = kNoEvent;
    Export& front = exporter_->exports.front();
    const FlowRay ray = front.rays[front.rays.size() - front.left];
    if (ray.shadow()) {
      --shadow_to_come_;
      --front.launch->shadow_left;
    } else {
      --normal_to_come_;
      --front.launch->normal_left;
    }
    // The port drops what is too deep, and with culling what adds nothing.
    if (ray.shadow() || ray.depth <= work_.depth) {
      ++rays_;
      if (ray.shadow()) ++shadow_rays_;
      flow_.rays += 1;
      coming_.emplace_back(now_ + kRead, ray);
    }
    end_exports(*exporter_, 1);
  }
  void end_exports(Unit& unit, uint32_t count) {
    Export& front = unit.exports.front();
    Launch& launch = *front.launch;
    front.left -= count;
    launch.unexported -= count;
    unit.warps[front.warp].exporting -= count;
    if (front.left == 0) unit.exports.pop_front();
    settle(launch);
  }

  // The traverser.

  bool hardware() const { return chip_.traverser == TraverserName::Hardware; }

  void read() {
    while (!coming_.empty() && coming_.front().first <= now_) {
      untraced_.push_back(coming_.front().second);
      coming_.pop_front();
    }
  }
  /// Of `static`: the oldest rays that it has read.
  void trace(uint32_t count) {
    read();
    for (; count > 0 && !untraced_.empty(); --count) {
      finish_ray(untraced_.front());
      untraced_.pop_front();
    }
  }
  void finish_ray(const FlowRay& ray) {
    const TileWork& work = tile(ray);
    const double share = ray.shadow() ? work.lit : ray.depth == 1 ? work.eye_hits : work.reflection_hits;
    if (!happens(share) || (ray.shadow() && chip_.shading == Shading::Traverser))
      free_place(ray);
    else
      results_.push_back({ray.tile, ray.depth, needs_no_reflection(ray)});
  }
  /// With culling, of a normal ray.
  bool needs_no_reflection(const FlowRay& ray) {
    return chip_.culling && work_.reflections && (ray.depth >= work_.depth || !happens(tile(ray).reflecting));
  }
  void free_place(const FlowRay& ray) {
    --rays_;
    if (ray.shadow()) --shadow_rays_;
  }
  ImportKind kind_of(const FlowRay& ray) const {
    if (ray.shadow()) return ImportKind::Shadow;
    return ray.direct ? ImportKind::Direct : ImportKind::Normal;
  }

  // Of `hardware`: rays in flight go on as fast as pipes and memory allow, all alike.

  double ray_ends() const {
    double next = kNoEvent;
    if (!hardware()) return next;
    if (!flight_.empty()) next = flight_at_ + std::max(0.0, flight_.begin()->first - flight_clock_) / flight_rate_;
    if (!coming_.empty() && flight_.size() < chip_.hardware_traverser_rays)
      next = std::min(next, std::max(now_, coming_.front().first));
    return next;
  }
  void fly() {
    if (!hardware()) return;
    flight_clock_ += (now_ - flight_at_) * flight_rate_;
    flow_.in_flight += (now_ - flight_at_) * static_cast<double>(flight_.size());
    flight_at_ = now_;
    while (!flight_.empty() && flight_.begin()->first <= flight_clock_ + 1e-6) {
      const FlowRay ray = flight_.begin()->second;
      flight_.erase(flight_.begin());
      share(ray, -1);
      finish_ray(ray);
    }
    while (!coming_.empty() && coming_.front().first <= now_ && flight_.size() < chip_.hardware_traverser_rays) {
      const FlowRay ray = coming_.front().second;
      coming_.pop_front();
      share(ray, 1);
      flow_.order.push_back({ray.tile, ray.depth});
      // A ray tests more or fewer than its tile's mean, most of them fewer.
      const double some = std::gamma_distribution<double>(kVariety, 1 / kVariety)(random_);
      flight_.emplace(flight_clock_ + flight_cycles(tile(ray)) * some, ray);
    }
    set_flight_rate();
  }
  double flight_cycles(const TileWork& work) const {
    return kFlight + kNode * work.nodes + kTriangle * work.triangles +
           kWaiting * (work_.reads.nodes + work_.reads.triangles) * (chip_.memory_latency + kMiss);
  }
  /// A ray in flight or no more: what it asks for a cycle of its way.
  void share(const FlowRay& ray, double sign) {
    const TileWork& work = tile(ray);
    const double a_cycle = sign / flight_cycles(work);
    boxes_ += work.nodes * a_cycle;
    tests_ += work.triangles * a_cycle;
    nodes_read_ += work_.reads.nodes * a_cycle;
    triangles_read_ += work_.reads.triangles * a_cycle;
  }
  void set_flight_rate() {
    const double boxes = boxes_ / chip_.hardware_traverser_lanes;
    const double tests = tests_ / chip_.hardware_traverser_triangle_pipes;
    const double memory = (nodes_read_ + triangles_read_) * kLineBeats * chip_.memory_cycles_per_beat;
    const double away = chip_.memory_latency + kMiss;
    const double node_lines = nodes_read_ * away / (kUsedMshrs * chip_.hardware_traverser_node_cache_mshrs);
    const double triangle_lines = triangles_read_ * away / (kUsedMshrs * chip_.hardware_traverser_triangle_cache_mshrs);
    const auto power = [](double load) { return std::pow(std::max(0.0, load), kFlightSharpness); };
    flight_rate_ = std::pow(1 + power(boxes) + power(tests) + power(memory) + power(node_lines) + power(triangle_lines),
                            -1 / kFlightSharpness);
  }

  void start_put() {
    if (put_ends_ != kNoEvent || results_.empty()) return;
    // The oldest of those whose kind has room.
    for (auto ray = results_.begin(); ray != results_.end(); ++ray) {
      if (size_[kind_of(*ray)] >= chip_.intersection_pool_size) continue;
      putting_ = *ray;
      results_.erase(ray);
      put_ends_ = now_ + put_service_;
      return;
    }
  }
  void end_put() {
    put_ends_ = kNoEvent;
    const ImportKind kind = kind_of(putting_);
    ++size_[kind];
    ++available_[kind];
    imports_[kind].push_back(putting_);
    free_place(putting_);
  }
  void watch_stall() {
    if (hardware()) return;
    bool stalls = std::all_of(units_.begin(), units_.end(), [](const Unit& unit) { return unit.running.empty(); });
    if (rays_ >= chip_.ray_pool_size && export_ends_ == kNoEvent)
      for (const Unit& unit : units_)
        stalls |=
            !unit.exports.empty() && !unit.exports.front().rays.empty() && unit.exports.front().offered_at <= now_;
    if (!stalls)
      stall_ends_ = kNoEvent;
    else if (stall_ends_ == kNoEvent && (!untraced_.empty() || !coming_.empty()))
      stall_ends_ = now_ + chip_.static_traverser_stall_cycles;
  }
  // The controller.

  bool tiles_left() const { return next_tile_ < work_.tiles.size(); }
  uint32_t held() const {
    return rays_ - shadow_rays_ + available_[ImportKind::Normal] + available_[ImportKind::Direct] +
           static_cast<uint32_t>(normal_to_come_);
  }
  uint32_t kernels() const {
    uint32_t sum = 0;
    for (const Unit& unit : units_)
      sum += static_cast<uint32_t>(unit.running.size()) + (unit.waiting != nullptr ? 1 : 0);
    return sum;
  }
  /// The unit that would take a launch; null: none is ready.
  Unit* ready_unit(bool& ahead) {
    ahead = false;
    for (size_t i = 0; i < units_.size(); ++i) {
      Unit& unit = units_[(launch_turn_ + i) % units_.size()];
      if (unit.running.empty() && unit.waiting == nullptr && unit.importing.empty()) return &unit;
    }
    ahead = true;
    if (!chip_.launch_ahead) return nullptr;
    for (size_t i = 0; i < units_.size(); ++i) {
      Unit& unit = units_[(launch_turn_ + i) % units_.size()];
      if (unit.waiting == nullptr && unit.importing.empty()) return &unit;
    }
    return nullptr;
  }
  void decide() {
    if (launch_at_ != kNoEvent) return;
    bool ahead = false;
    if (ready_unit(ahead) == nullptr) return;
    for (const Unit& unit : units_) ahead &= !(unit.running.empty() && unit.waiting == nullptr);
    PolicyView view;
    const ImportKind secondary =
        available_[ImportKind::Direct] > available_[ImportKind::Normal] ? ImportKind::Direct : ImportKind::Normal;
    view.rays = rays_;
    view.normal = available_[secondary];
    view.shadow = available_[ImportKind::Shadow];
    view.rays_to_come = static_cast<uint32_t>(normal_to_come_ + shadow_to_come_);
    for (const ImportKind kind : {ImportKind::Normal, ImportKind::Shadow, ImportKind::Direct})
      view.promised += size_[kind] - available_[kind];
    view.more_to_come = rays_ > 0 || view.rays_to_come > 0;
    view.secondary_room = rules_.secondary_room(shadow_rays_, static_cast<uint32_t>(shadow_to_come_), view.shadow);
    view.kernels = kernels();
    view.eye_possible = tiles_left() && rules_.may_cast(work_.tiles[next_tile_].pixels, held());
    view.ahead = ahead;
    const Choice choice = policy_->choose(view);
    if (choice.kind == Choice::Kind::Halt) return;
    next_ = Launch{};
    next_held_ = held();
    switch (choice.kind) {
      case Choice::Kind::Eye:
        next_.kernel = RayKernel::CastEye;
        next_.threads = work_.tiles[next_tile_].threads;
        next_.tile = next_tile_;
        break;
      case Choice::Kind::Secondary:
        next_.import = secondary;
        next_.kernel = work_.reflections && secondary == ImportKind::Normal ? RayKernel::CastSecondary
                                                                            : RayKernel::CastSecondaryDirect;
        next_.threads = choice.threads;
        break;
      default:
        next_.import = ImportKind::Shadow;
        next_.kernel = RayKernel::Shade;
        next_.threads = choice.threads;
    }
    if (next_.threads == 0) return;
    launch_at_ = now_ + kDecide;
  }
  void take_launch() {
    bool ahead = false;
    Unit* unit = ready_unit(ahead);
    if (unit == nullptr) return;  // offered until it is taken
    launch_at_ = kNoEvent;
    launch_turn_ = static_cast<size_t>(unit - units_.data() + 1) % units_.size();
    launches_.push_back(std::move(next_));
    Launch& launch = launches_.back();
    launch.taken_at = now_;
    launch.warps = (launch.threads + configuration_.lanes - 1) / configuration_.lanes;
    flow_.launches[launch.kernel] += 1;
    flow_.threads[launch.kernel] += launch.threads;
    switch (launch.kernel) {
      case RayKernel::CastEye:
        rules_.cast(next_held_);
        launch.normal_left = work_.tiles[launch.tile].pixels;
        cast(launch.tile);
        break;
      case RayKernel::CastSecondary:
        launch.normal_left = launch.threads;
        [[fallthrough]];
      case RayKernel::CastSecondaryDirect:
        launch.shadow_left = launch.threads;
        break;
      case RayKernel::Shade:
        break;
    }
    normal_to_come_ += launch.normal_left;
    shadow_to_come_ += launch.shadow_left;
    if (launch.import != ImportKind::None) {
      available_[launch.import] -= launch.threads;
      std::deque<FlowRay>& from = imports_[launch.import];
      launch.imports.assign(from.begin(), from.begin() + launch.threads);
      from.erase(from.begin(), from.begin() + launch.threads);
      unit->importing.push_back(&launch);
    }
    unit->waiting = &launch;
    begin_waiting(*unit);
    advance(*unit);
  }
  void cast(uint32_t tile) {
    next_tile_ = tile + 1;
    const uint32_t tiles = static_cast<uint32_t>(work_.tiles.size()), first = tiles / kFilling;
    if (tile == first) steady_from_ = now_;
    if (tile + 1 != tiles || tile <= first) return;
    flow_.steady_cycles = now_ - steady_from_;
    for (uint32_t i = first; i < tile; ++i) flow_.steady_rays += work_.tiles[i].rays;
  }
  bool finished() const {
    if (tiles_left() || rays_ != 0 || launch_at_ != kNoEvent || !launches_.empty()) return false;
    return std::all_of(size_.begin(), size_.end(), [](uint32_t size) { return size == 0; });
  }

  const Configuration& configuration_;
  const ChipConfiguration& chip_;
  const Workload& work_;
  const EnumArray<RayKernel, KernelCosts, kRayKernels>& kernels_;
  uint32_t contents_;
  LaunchRules rules_;
  std::unique_ptr<KernelPolicy> policy_;
  std::vector<Unit> units_;
  std::array<double, kMostUnits> last_end_{};
  double export_service_ = 5, import_service_ = 8, put_service_ = 6;

  double now_ = 0;
  LaunchList launches_;
  Launch next_;
  uint32_t next_held_ = 0;
  double launch_at_ = kNoEvent, import_ends_ = kNoEvent, import_starts_ = kNoEvent, export_ends_ = kNoEvent,
         put_ends_ = kNoEvent, stall_ends_ = kNoEvent;
  Unit *importer_ = nullptr, *exporter_ = nullptr;
  size_t import_turn_ = 0, export_turn_ = 0, launch_turn_ = 0;
  uint32_t next_tile_ = 0;
  double steady_from_ = 0;
  uint32_t rays_ = 0, shadow_rays_ = 0;  // in the ray pool
  double normal_to_come_ = 0, shadow_to_come_ = 0;
  std::deque<std::pair<double, FlowRay>> coming_;  // when the traverser has read it
  std::deque<FlowRay> untraced_, results_;
  EnumArray<ImportKind, std::deque<FlowRay>, kImportKinds> imports_;  // not promised to a launch
  FlowRay putting_{};
  std::multimap<double, FlowRay> flight_;  // by the end of its way, on the clock of all rays in flight
  double flight_clock_ = 0, flight_rate_ = 1, flight_at_ = 0;
  double boxes_ = 0, tests_ = 0, nodes_read_ = 0, triangles_read_ = 0;  // that rays in flight ask for a cycle
  EnumArray<ImportKind, uint32_t, kImportKinds> size_{}, available_{};
  std::mt19937 random_{1};
  Flow flow_;
};

}  // namespace

Flow flow_of(const Configuration& configuration, uint32_t units, const Workload& work,
             const EnumArray<RayKernel, KernelCosts, kRayKernels>& kernels) {
  return LaunchFlow(configuration, units, work, kernels).run();
}

}  // namespace raypool::estimate
