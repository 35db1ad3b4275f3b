// For tests: a world where rays hit and miss by a hash of pixel and depth, and a compute unit that stands in for
// the ray kernels in it, obeying the port protocols with random delays, so that a run's every ray is known beforehand.
#pragma once

#include <algorithm>
#include <array>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "chip/chip.hpp"

namespace raypool::test {

/// What happens to the rays of a pixel.
struct World {
  uint32_t seed = 1;
  int misses = 6;      ///< of 16 normal rays
  int blocked = 4;     ///< of 16 shadow rays
  int shadows = 14;    ///< of 16 hits that make a shadow ray
  int mirrors = 10;    ///< of 16 hits that make a reflection
  bool black = false;  ///< the rays that a hit does not make are exported too, without weight

  int roll(uint32_t pixel, uint32_t depth, uint32_t what) const {
    uint32_t h = seed * 0x9e3779b1u ^ pixel * 0x85ebca6bu ^ depth * 0xc2b2ae35u ^ what * 0x27d4eb2fu;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return static_cast<int>((h ^ h >> 15) >> 28);
  }
  bool hit(uint32_t pixel, uint32_t depth) const { return roll(pixel, depth, 0) >= misses; }
  bool is_blocked(uint32_t pixel, uint32_t depth) const { return roll(pixel, depth, 1) < blocked; }
  bool makes_shadow(uint32_t pixel, uint32_t depth) const { return roll(pixel, depth, 2) < shadows; }
  bool makes_reflection(uint32_t pixel, uint32_t depth) const { return roll(pixel, depth, 3) < mirrors; }
};

/// A frame of the world, counted without a machine.
struct Expected {
  uint64_t eye = 0, secondary = 0, shadow = 0, missed = 0, blocked = 0, beyond = 0;
  uint64_t deepest = 0;  ///< hits of rays with reflections, made or not, that are beyond
  std::map<std::pair<uint32_t, uint32_t>, int> contributions;  ///< (pixel, depth) -> how often

  Expected(const World& world, int width, int height, int depth_limit) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x)
        follow(world, static_cast<uint32_t>(x | y << 16), static_cast<uint32_t>(depth_limit));
    }
  }

 private:
  void follow(const World& world, uint32_t pixel, uint32_t limit) {
    for (uint32_t depth = 1;; ++depth) {
      if (depth > limit) {
        ++beyond;
        return;
      }
      ++(depth == 1 ? eye : secondary);
      if (!world.hit(pixel, depth)) {
        ++missed;
        return;
      }
      deepest += depth == limit && limit > 1;
      if (world.makes_shadow(pixel, depth)) {
        ++shadow;
        if (world.is_blocked(pixel, depth)) {
          ++blocked;
        } else {
          ++contributions[{pixel, depth}];
        }
      }
      if (limit == 1 || !world.makes_reflection(pixel, depth)) return;
    }
  }
};

class WorldTracer : public RayTracer {
 public:
  explicit WorldTracer(const World& world) : world_(world) {}
  bool trace(const Ray& ray, Intersection& intersection) override {
    intersection = {};
    std::copy(ray.begin(), ray.end(), intersection.begin());
    const uint32_t pixel = ray[word::kPixel], depth = ray[word::kFlags] & kDepthMask;
    if ((ray[word::kFlags] & kShadowFlag) != 0) return !world_.is_blocked(pixel, depth);
    intersection[word::kTriangle] = pixel ^ depth;
    return world_.hit(pixel, depth);
  }
  bool reflects(const Intersection& hit) const override {
    return world_.makes_reflection(hit[word::kPixel], hit[word::kFlags] & kDepthMask);
  }

 private:
  World world_;
};

class WorldFrame : public FrameSink {
 public:
  void add(const FrameContribution& contribution) override {
    ++contributions[{contribution.pixel, contribution.rgb[0]}];
  }
  std::map<std::pair<uint32_t, uint32_t>, int> contributions;  ///< (pixel, depth) -> how often
};

/// Entries of the scripted kernels: the PC is the RayKernel's number.
inline constexpr EnumArray<RayKernel, uint32_t, kRayKernels> kScriptedEntries = {0, 1, 2, 3};

class ScriptedUnit : public ComputeUnit {
 public:
  /// `pace`: kernels compute for up to so many cycles. Reads lines of `memory` meanwhile, and checks them.
  ScriptedUnit(const World& world, uint32_t contents, int pace, uint32_t seed, const Memory& memory)
      : world_(world), contents_(contents), pace_(pace), random_(seed), memory_(memory) {}

  void reset(uint32_t, uint32_t) override {
    outputs_.exports = {};
    present();
  }
  void set_argument(uint32_t index, uint32_t value) override { arguments_.at(index) = value; }
  const UnitOutputs& outputs() const override { return outputs_; }
  const UnitTrace& trace() const override { return trace_; }
  uint64_t counter(int number) override {
    return number == counter::kBusyCycles ? busy_ : number == counter::kInstructions ? steps_ : 0;
  }
  bool timed() const override { return true; }

  void clock(const UnitInputs& in) override {
    busy_ += outputs_.busy != 0;
    transfer(in);
    outputs_.kernel_done = 0;
    step();
    present();
  }

  void set_world(const World& world) { world_ = world; }

  std::optional<Fault> fault_at_start;  ///< of the next kernel
  bool hang = false;                    ///< kernels never end

 private:
  struct Kernel {
    LaunchCommand command;
    int phase = 0;
    int wait = 0;
  };
  struct Item {
    bool to_frame;
    Ray ray;
    FrameContribution frame;
  };

  static void require(bool holds, const char* what) {
    if (!holds) throw std::logic_error(std::string("protocol: ") + what);
  }
  int roll(int below) { return static_cast<int>(random_() % static_cast<uint32_t>(below)); }

  void transfer(const UnitInputs& in) {
    if (outputs_.launch_ready && in.launch_valid) {
      require(in.launch.threads >= 1 && in.launch.threads <= contents_, "threads of a launch");
      require(in.launch.pc < kRayKernels, "entry of a launch");
      waiting_ = Kernel{in.launch};
      if (in.launch.import != ImportKind::None) {
        import_kind_ = in.launch.import;
        to_request_ = in.launch.threads;
        expected_.push_back(in.launch.threads);
      }
    }
    if (outputs_.import_request_valid && in.import_request_ready) {
      --to_request_;
      ++requested_;
      import_kinds_.push_back(import_kind_);
    }
    if (in.import_beat_valid) {
      require(requested_ > 0, "a beat without a request");
      for (size_t i = 0; i < kBeatWords; ++i) {
        const size_t number = beats_ * kBeatWords + i;
        if (number < kIntersectionWords) package_[number] = in.import_beat[i];
      }
      if (++beats_ == kIntersectionBeats) {
        beats_ = 0;
        --requested_;
        const bool shadow = (package_[word::kFlags] & kShadowFlag) != 0;
        require(shadow == (import_kinds_.front() == ImportKind::Shadow), "a package of the wrong kind");
        require(shadow || package_[word::kTriangle] == (package_[word::kPixel] ^ (package_[word::kFlags] & kDepthMask)),
                "a package's words");
        import_kinds_.pop_front();
        arrived_.push_back(package_);
      }
    }
    if (outputs_.export_valid && in.export_ready) {
      if (++export_beat_ == kRayBeats) {
        export_beat_ = 0;
        exports_.pop_front();
      }
      if (roll(4) == 0) bubble_ = 1 + roll(2);
    }
    if (outputs_.frame_valid && in.frame_ready) exports_.pop_front();
    if (outputs_.memory_request_valid && in.memory_request_ready) {
      reads_.push_back({outputs_.memory_request.address, outputs_.memory_request.id});
      asking_ = false;
    }
    if (in.memory_response_valid) {
      require(!reads_.empty() && reads_.front().second == in.memory_response.id, "a response that was not asked for");
      require(in.memory_response.beat == read_beat_, "beats of a line out of order");
      for (uint32_t i = 0; i < kBeatWords; ++i) {
        require(in.memory_response.data[i] == memory_.load(reads_.front().first + read_beat_ * 16 + i * 4),
                "data of a line");
      }
      if (++read_beat_ == 4) {
        read_beat_ = 0;
        reads_.pop_front();
      }
    }
  }

  void step() {
    if (bubble_ > 0) --bubble_;
    if (!running_ && waiting_) {
      running_ = waiting_;
      waiting_.reset();
      if (fault_at_start) outputs_.fault = *fault_at_start;
    }
    if (!running_ || outputs_.fault.code != FaultCode::None || hang) return;
    Kernel& kernel = *running_;
    if (kernel.wait > 0) {
      --kernel.wait;
      ++steps_;
      if (!asking_ && reads_.size() < 4 && memory_.size() >= 64 && roll(8) == 0) {
        asking_ = true;
        address_ = random_() % (memory_.size() / 64) * 64;
        id_ = static_cast<uint8_t>(roll(32));
      }
      return;
    }
    switch (kernel.phase) {
      case 0:  // rin
        if (kernel.command.import != ImportKind::None) {
          if (arrived_.size() < kernel.command.threads) return;
          require(expected_.front() == kernel.command.threads, "order of imports");
          expected_.pop_front();
          current_.assign(arrived_.begin(), arrived_.begin() + kernel.command.threads);
          arrived_.erase(arrived_.begin(), arrived_.begin() + kernel.command.threads);
        }
        break;
      case 1:
      case 2:  // rout, rfb
        if (!exports_.empty()) return;
        make(kernel.command, kernel.phase == 1);
        outputs_.exports[0] = static_cast<uint16_t>(outputs_.exports[0] + exports_.size());
        break;
      default:
        if (asking_) return;  // reads that are under way may outlive the kernel, as a prefetch does
        outputs_.kernel_done = 1;
        running_.reset();
        return;
    }
    ++kernel.phase;
    ++steps_;
    kernel.wait = roll(pace_ + 1);
  }

  void make(const LaunchCommand& command, bool first) {
    const auto kernel = static_cast<RayKernel>(command.pc);
    const auto ray = [&](uint32_t pixel, uint32_t flags, bool black = false) {
      Ray made{};
      made[word::kPixel] = pixel;
      made[word::kFlags] = flags;
      made[word::kColor] = black ? 0 : flags & kDepthMask;
      exports_.push_back({false, made, {}});
    };
    if (kernel == RayKernel::CastEye) {
      if (!first) return;
      const uint32_t log2 = arguments_[argument::kTileWidthLog2], mask = arguments_[argument::kTileMask];
      for (uint32_t t = 0; t < command.threads; ++t) {
        const uint32_t x = (command.block & 0xffff) + (t & mask), y = (command.block >> 16) + (t >> log2);
        if (x < arguments_[argument::kWidth] && y < arguments_[argument::kHeight]) ray(x | y << 16, 1);
      }
      return;
    }
    for (const Intersection& package : current_) {
      const uint32_t pixel = package[word::kPixel], depth = package[word::kFlags] & kDepthMask;
      if (kernel == RayKernel::Shade) {
        if (first) exports_.push_back({true, {}, {pixel, {depth, 0, 0}}});
      } else if (!first) {
        const bool made = world_.makes_shadow(pixel, depth);
        if (made || world_.black) ray(pixel, depth | kShadowFlag, !made);
      } else if (kernel == RayKernel::CastSecondary) {
        const bool made = world_.makes_reflection(pixel, depth);
        if (made || world_.black) ray(pixel, depth + 1, !made);
      }
    }
  }

  void present() {
    outputs_.launch_ready = !waiting_ && to_request_ == 0;
    outputs_.busy = running_.has_value() ? 1 : 0;
    outputs_.idle = !running_ && !waiting_ && exports_.empty();
    outputs_.unit_idle = outputs_.idle ? 1 : 0;
    outputs_.import_request_valid = to_request_ > 0 && arrived_.size() + requested_ < contents_;
    outputs_.import_request_kind = import_kind_;
    const bool shown = !exports_.empty() && bubble_ == 0;
    outputs_.export_valid = shown && !exports_.front().to_frame;
    outputs_.frame_valid = shown && exports_.front().to_frame;
    if (outputs_.export_valid) {
      for (size_t i = 0; i < kBeatWords; ++i)
        outputs_.export_data[i] = exports_.front().ray[export_beat_ * kBeatWords + i];
      outputs_.export_last = export_beat_ + 1 == kRayBeats;
    }
    if (outputs_.frame_valid) outputs_.frame = exports_.front().frame;
    outputs_.memory_request_valid = asking_;
    outputs_.memory_request = {false, address_, {}, 0, id_};
  }

  World world_;
  uint32_t contents_;
  int pace_;
  std::mt19937 random_;
  const Memory& memory_;
  std::array<uint32_t, kArguments> arguments_{};
  UnitOutputs outputs_;
  UnitTrace trace_;
  std::optional<Kernel> waiting_, running_;
  ImportKind import_kind_ = ImportKind::None;
  uint32_t to_request_ = 0, requested_ = 0;
  std::deque<uint32_t> expected_;
  std::deque<ImportKind> import_kinds_;
  size_t beats_ = 0;
  Intersection package_{};
  std::vector<Intersection> arrived_, current_;
  std::deque<Item> exports_;
  size_t export_beat_ = 0;
  int bubble_ = 0;
  bool asking_ = false;
  uint32_t address_ = 0;
  uint8_t id_ = 0;
  std::deque<std::pair<uint32_t, uint8_t>> reads_;
  uint32_t read_beat_ = 0;
  uint64_t busy_ = 0, steps_ = 0;
};

}  // namespace raypool::test
