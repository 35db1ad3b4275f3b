// For tests: random surroundings of a chip. A memory that takes and answers when it likes, a frame buffer that does not
// always take, and a traverser that knows no scene: of each ray it decides at random what becomes of it, and when, and
// asks for trees that it does not read.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "bits.hpp"
#include "machine/chip/chip_device.hpp"
#include "random.hpp"

namespace raypool::test {

/// One in so many cycles, 0 never: a port that could take something does not; of a package being put a beat is late;
/// the traverser asks for its tree. It has so many rays inside at most, and each for so many cycles at most; they leave
/// in cycles that are multiples of `burst`. With `frame` the frame buffer takes one in so many cycles only. The memory
/// has a line's first beat so many cycles after its request at most. With `shut` each port takes nothing for so many
/// cycles, and then is open for as many, so that what is before it fills up and then leaves while more comes. Of one in
/// `age` rays the traverser makes one that has been reflected many times.
struct Traffic {
  uint32_t stall = 0, gap = 0, tree = 0;
  uint32_t inside = 1000, cycles = 1, latency = 1, burst = 1, frame = 0, shut = 0, age = 0;
};

/// A port that is shut for `period` cycles, then open for as many; 0: always open. Ports have periods of their own.
inline bool is_shut(uint32_t period, uint64_t cycle, uint32_t port) {
  return period != 0 && cycle / (period + port * (period / 7)) % 2 == 1;
}

class Surroundings {
 public:
  struct Scene {
    uint32_t material_base = 0, materials = 1;  ///< records in the memory
    RecordLayout layout;
    Shading shading = Shading::Kernel;
    bool culling = false, reflections = false;
  };

  Surroundings(ChipDevice& chip, const Configuration& configuration, Memory& memory, const Scene& scene, uint32_t seed)
      : chip_(chip),
        beats_(configuration.intersection_beats()),
        places_(configuration.chip.ray_pool_size),
        memory_(memory),
        scene_(scene),
        random_(seed) {}

  /// Clocks once.
  void cycle(const Traffic& traffic) {
    const ChipOutputs& out = chip_.outputs();
    ChipInputs in;
    in.start = !out.ready && hasty_() % 16 == 0;  // which is refused
    serve_memory(out, in, traffic);
    in.frame_ready = (traffic.frame != 0 ? one_of(traffic.frame) : !one_of(traffic.stall)) && !shut(traffic, 0);
    frame += out.frame_valid && in.frame_ready;
    take_rays(out, in, traffic);
    put(out, in, traffic);
    contribute(out, in);
    free_places(in);
    ask_for_tree(out, in, traffic);
    count(out);
    chip_.clock(in);
    ++cycles;
  }

  bool empty() const { return inside_.empty() && lines_.empty() && leaving_.empty(); }

  uint64_t cycles = 0, frame = 0;                                    ///< contributions that came out
  uint64_t rays = 0, freed = 0, packages = 0;                        ///< of the traverser
  uint64_t own_contributions = 0, tree_lines = 0;                    ///< likewise
  uint64_t eye = 0, dropped = 0, deep = 0, black = 0;                ///< rays that left the units
  uint64_t unit_contributions = 0, requests = 0;                     ///< of the units; intersections
  uint64_t held_up = 0, full = 0, frame_waited = 0, overlapped = 0;  ///< full: cycles, of a kind of intersections
  uint64_t launches[kRayKernels] = {};
  uint64_t of_unit[kMostUnits] = {};  ///< rays
  FrameSetup setup;                   ///< of the frame, to know kernels by

 private:
  static constexpr uint32_t kMostAged = 250;  // reflections: the kernels count on from there, within eight bits
  struct Inside {
    uint32_t place = 0;
    bool shadow = false;
    uint64_t done = 0;  // cycle
    ImportKind becomes = ImportKind::None;
    bool contributes = false;
    Intersection record{};
    FrameContribution contribution;
  };
  struct Line {
    bool traverser;
    uint64_t from;
    Beat data;
  };

  bool one_of(uint32_t number) { return number != 0 && random_() % number == 0; }
  bool shut(const Traffic& traffic, uint32_t port) const { return is_shut(traffic.shut, cycles, port); }
  float share() { return static_cast<float>(random_() % 1000) / 1000; }

  Beat line_data(bool traverser, uint32_t address) const {
    Beat beat;
    for (uint32_t i = 0; i < kBeatWords; ++i)
      beat[i] = traverser ? (address + 4 * i) * 0x9e3779b9u : memory_.load(address + 4 * i);
    return beat;
  }

  void serve_memory(const ChipOutputs& out, ChipInputs& in, const Traffic& traffic) {
    in.memory_beat_valid = !lines_.empty() && lines_.front().from <= cycles && !shut(traffic, 1);
    if (in.memory_beat_valid) in.memory_beat_data = lines_.front().data;
    if (in.memory_beat_valid && out.memory_beat_ready) lines_.pop_front();
    in.memory_request_ready = !one_of(traffic.stall) && !shut(traffic, 2);
    if (!out.memory_request_valid || !in.memory_request_ready) return;
    const MemoryRequest& request = out.memory_request.request;
    if (request.write) {
      for (uint32_t i = 0; i < kBeatWords && !out.memory_request.traverser; ++i)
        if ((request.mask >> i & 1) != 0) memory_.store(request.address + 4 * i, request.data[i]);
      return;
    }
    uint64_t from = cycles + 1 + random_() % traffic.latency;
    for (uint32_t beat = 0; beat < MemoryLine::kBeats; ++beat, from += one_of(4) ? 1 : 0) {
      const uint32_t address = request.address + beat * MemoryLine::kQuadwordBytes;
      lines_.push_back({out.memory_request.traverser, from, line_data(out.memory_request.traverser, address)});
      if (out.memory_request.traverser) tree_beats_.push_back(lines_.back().data);
    }
  }

  void take_rays(const ChipOutputs& out, ChipInputs& in, const Traffic& traffic) {
    in.ray_ready = inside_.size() + leaving_.size() < traffic.inside && !one_of(traffic.stall) && !shut(traffic, 3);
    if (!out.ray_valid || !in.ray_ready) return;
    std::copy(out.ray_data.begin(), out.ray_data.end(), &ray_[ray_beats_ * kBeatWords]);
    ++ray_beats_;
    ASSERT_EQ(out.ray_last, ray_beats_ == kRayBeats);
    if (!out.ray_last) return;
    ray_beats_ = 0;
    ASSERT_LT(out.ray_place, places_.size());
    ASSERT_FALSE(places_[out.ray_place]) << "two rays in one place";
    places_[out.ray_place] = true;
    ++rays;
    inside_.push_back(traced(out.ray_place, traffic));
  }

  Inside traced(uint32_t place, const Traffic& traffic) {
    Inside ray;
    ray.place = place;
    ray.shadow = (ray_[word::kFlags] & kShadowFlag) != 0;
    ray.done = cycles + 1 + random_() % traffic.cycles;
    ray.done += traffic.burst - 1 - (ray.done + traffic.burst - 1) % traffic.burst;
    const bool something = !one_of(4);
    if (ray.shadow && something && scene_.shading == Shading::Traverser) {
      ray.contributes = true;
      ray.contribution = {ray_[word::kPixel], {ray_[word::kColor], ray_[word::kColor + 1], ray_[word::kColor + 2]}};
    } else if (something) {
      ray.becomes = ray.shadow ? ImportKind::Shadow : ImportKind::Normal;
      if (!ray.shadow && scene_.culling && scene_.reflections && one_of(3)) ray.becomes = ImportKind::Direct;
      Intersection hit{};
      std::copy(ray_.begin(), ray_.end(), hit.begin());
      hit[word::kDistance] = as_bits(1 + share());
      hit[word::kBarycentric] = as_bits(share());
      hit[word::kBarycentric + 1] = as_bits(share());
      for (int axis = 0; axis < 3; ++axis) hit[word::kNormal + axis] = as_bits(share() - 0.5f);
      hit[word::kMaterial] = scene_.material_base + random_() % scene_.materials * kMaterialBytes;
      hit[word::kTriangle] = random_() % 1000;
      if (one_of(traffic.age)) {
        const uint32_t depth = hit[word::kFlags] & kDepthMask;
        hit[word::kFlags] += std::min(kMostAged - std::min(depth, kMostAged), static_cast<uint32_t>(random_() % 256));
      }
      ray.record = packed(hit, scene_.layout);
    }
    return ray;
  }

  // Rays leave in any order; one with no room for its intersections lets others pass.
  void put(const ChipOutputs& out, ChipInputs& in, const Traffic& traffic) {
    if (put_beats_ == 0 && !put_waits_) {
      const auto may_go = [&](const Inside& ray) {
        return ray.done <= cycles && ray.becomes != ImportKind::None &&
               (out.put_ready >> to_underlying(ray.becomes) & 1) != 0;
      };
      const auto found = std::find_if(inside_.begin(), inside_.end(), may_go);
      const auto any = std::find_if(inside_.begin(), inside_.end(), [&](const Inside& ray) {
        return ray.done <= cycles && ray.becomes != ImportKind::None;
      });
      // A ray that is put without looking for room waits, and the others behind it: while there will be some.
      const bool waits = found == inside_.end() && any != inside_.end() && out.device.import_request_valid &&
                         out.device.import_request_kind == any->becomes;
      if (found == inside_.end() && !waits) return;
      const auto chosen = waits ? any : found;
      put_ = *chosen;
      inside_.erase(chosen);
      put_waits_ = true;
    }
    in.put_valid = !one_of(traffic.gap);
    if (!in.put_valid) return;
    in.put_kind = put_.becomes;
    for (uint32_t i = 0, from = put_beats_ * kBeatWords; i < kBeatWords; ++i, ++from)
      in.put_data[i] = from < put_.record.size() ? put_.record[from] : 0;
    const bool taken = (out.put_ready >> to_underlying(in.put_kind) & 1) != 0;
    if (!taken || ++put_beats_ < beats_) return;
    put_beats_ = 0;
    put_waits_ = false;
    ++packages;
    leaving_.emplace_back(put_.place, put_.shadow);
  }

  void contribute(const ChipOutputs& out, ChipInputs& in) {
    const auto found = std::find_if(inside_.begin(), inside_.end(),
                                    [&](const Inside& ray) { return ray.done <= cycles && ray.contributes; });
    if (!contributing_ && found != inside_.end()) {
      contributing_ = *found;
      inside_.erase(found);
    }
    if (contributing_) {
      in.contribution_valid = true;
      in.contribution = contributing_->contribution;
      if (out.contribution_ready) {
        ++own_contributions;
        leaving_.emplace_back(contributing_->place, contributing_->shadow);
        contributing_.reset();
      }
    }
    const auto lost = std::find_if(inside_.begin(), inside_.end(), [&](const Inside& ray) {
      return ray.done <= cycles && !ray.contributes && ray.becomes == ImportKind::None;
    });
    if (lost == inside_.end()) return;
    leaving_.emplace_back(lost->place, lost->shadow);
    inside_.erase(lost);
  }

  // In the cycle in which the last beat of what it becomes is taken, or later.
  void free_places(ChipInputs& in) {
    if (leaving_.empty() || one_of(3)) return;
    in.free_valid = true;
    in.free_place = leaving_.front().first;
    in.free_shadow = leaving_.front().second;
    places_[in.free_place] = false;
    leaving_.pop_front();
    ++freed;
  }

  void ask_for_tree(const ChipOutputs& out, ChipInputs& in, const Traffic& traffic) {
    if (out.tree_response_valid) {
      ASSERT_FALSE(tree_beats_.empty());
      ASSERT_EQ(out.tree_response_data, tree_beats_.front());
      tree_beats_.pop_front();
      tree_lines += out.tree_response_beat == 3;
    }
    if (!tree_waits_ && one_of(traffic.tree)) {
      tree_waits_ = true;
      tree_.write = one_of(4);
      tree_.second = one_of(2);
      const uint32_t bytes = (tree_.write ? MemoryLine::kQuadwordBytes : MemoryLine::kBytes) << tree_.second;
      tree_.address = random_() & ~(bytes - 1);
      for (Beat& beat : tree_.data)
        for (uint32_t& word : beat) word = random_();
    }
    in.tree_request_valid = tree_waits_;
    in.tree_request = tree_;
    if (tree_waits_ && out.tree_request_ready) tree_waits_ = false;
  }

  void count(const ChipOutputs& out) {
    if (out.outcome.valid) {
      eye += out.outcome.eye;
      dropped += !out.outcome.kept;
      deep += out.outcome.deep;
      black += !out.outcome.kept && !out.outcome.deep;
      ++of_unit[out.outcome.unit];
    }
    unit_contributions += out.exported_valid;
    requests += out.device.import_request_valid && out.to_device.import_request_ready;
    held_up += out.held_up;
    frame_waited += out.device.frame_valid && !out.to_device.frame_ready;
    full += (~out.put_ready & (scene_.culling ? 14u : 6u)) != 0;
    if (!out.to_device.launch_valid || !out.device.launch_ready) return;
    overlapped += (out.device.busy >> out.device.launch_unit & 1) != 0;
    for (size_t kernel = 0; kernel < kRayKernels; ++kernel)
      launches[kernel] += out.to_device.launch.pc == setup.entries[static_cast<RayKernel>(kernel)];
  }

  ChipDevice& chip_;
  uint32_t beats_;
  std::vector<bool> places_;  // taken
  Memory& memory_;
  Scene scene_;
  Random random_;
  Random hasty_{1};         // a host that asks for frames while one is drawn
  std::deque<Line> lines_;  // beats to come
  std::deque<Beat> tree_beats_;
  std::array<uint32_t, kRayWords> ray_{};
  uint32_t ray_beats_ = 0, put_beats_ = 0;
  std::deque<Inside> inside_;
  Inside put_{};
  std::optional<Inside> contributing_;
  bool put_waits_ = false, tree_waits_ = false;
  std::deque<std::pair<uint32_t, bool>> leaving_;
  TreeRequest tree_;
};

}  // namespace raypool::test
