// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_ray_exit.v: what becomes of rays that have visited everything: nothing, a contribution, or a
// package, for which a hit's triangle is read and what it carries computed.
//
// Outputs, read before clock(), are valid for the whole cycle and do not depend on its inputs.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "bits.hpp"
#include "enum_array.hpp"
#include "machine/common/free_list.hpp"
#include "machine/common/packages.hpp"
#include "machine/common/ram_queue.hpp"
#include "machine/common/round_robin.hpp"
#include "machine/compute/compute_unit.hpp"
#include "machine/traverser/lane_hits.hpp"
#include "machine/traverser/leaf_reader.hpp"
#include "machine/traverser/ray_finish.hpp"

namespace raypool {

class RayExit {
 public:
  struct Sizes {
    uint32_t lanes = 8, slots = 24;  ///< of each lane; as many hits can wait for their triangles
    uint32_t pool = 512;             ///< places
    uint32_t record_words = kIntersectionWords;
    bool contributes = false;  ///< shadow rays that meet nothing are contributions
    bool culling = false;
    bool miss_records = false;  ///< rays return that ask for it
  };
  /// What stays for a frame.
  struct Frame {
    uint32_t material_base = 0;  ///< bytes
    RecordLayout layout;
    uint32_t depth = 1;        ///< of normal rays
    bool reflections = false;  ///< normal packages are for the kernel that reflects
  };
  /// What a slot's ray leaves with.
  struct Set {
    uint32_t place = 0, depth = 0;
    bool shadow = false;
    bool returns = false, first = false;  ///< with miss_records: no shadow ray, and it returns; and any hit ends it
    TriangleRay ray{};
    int scale = 0;
  };
  struct Done {
    uint32_t lane = 0, slot = 0;
    LaneHits::Hit hit;
  };
  struct Slot {
    uint32_t lane, slot;
  };
  struct Inputs {
    const Ray* ray = nullptr;  ///< that comes, with its place
    uint32_t ray_place = 0;
    const Set* set = nullptr;  ///< it is set up, for this slot
    Slot set_slot{0, 0};
    const Done* done = nullptr;  ///< of choose()
    uint32_t taken = 0;          ///< bit i: wants()[i]
    bool waited = false;         ///< a line is taken for which a hit has waited
    const LeafReader::Given* given = nullptr;
    uint32_t put_ready = 0;  ///< mask: bit of ImportKind
    bool contribution_ready = false;
  };
  static constexpr uint32_t kMaterialReflects = 1u << 31;  ///< in a triangle's material word

  explicit RayExit(const Sizes& sizes)
      : sizes_(sizes),
        beats_((sizes.record_words + kBeatWords - 1) / kBeatWords),
        sets_(sizes.lanes * sizes.slots),
        entries_(sizes.slots),
        hits_(sizes.slots),
        reader_(sizes.slots),
        rays_(sizes.pool),
        finished_(sizes.pool),
        packages_(kImportKinds, RamQueue<Package>(sizes.pool)),
        contributions_(sizes.pool) {}

  void set_frame(const Frame& frame) { frame_ = frame; }

  /// The lane that has its ray taken, if one can be.
  std::optional<uint32_t> choose(uint32_t done) const {
    if (done == 0 || (fate_ && !fate_moves())) return {};
    return done_turn_.choose(done);
  }
  /// A slot that is free in the next cycle.
  std::optional<Slot> freed_slot() const {
    if (!fate_ || !fate_moves()) return {};
    return Slot{fate_->lane, fate_->slot};
  }

  bool wants_any() const { return reader_.wants_any(); }
  const LineWants& wants() const { return reader_.wants(); }  ///< stay where they are
  bool room() const { return reader_.room(); }

  bool free_valid() const { return put_free_ || contributed_ || (fate_ && drops()); }
  /// Mean something while free_valid().
  uint32_t free_place() const {
    return put_free_ ? put_free_place_ : contributed_ ? contribution_place_ : set_of(*fate_).place;
  }
  bool free_shadow() const { return put_free_ ? put_free_shadow_ : contributed_ || set_of(*fate_).shadow; }

  bool put_valid() const { return puts_; }
  /// Mean something while put_valid().
  ImportKind put_kind() const { return put_kind_; }
  Beat put_data() const {
    Beat beat{};
    for (uint32_t i = 0; i < kBeatWords; ++i) {
      const uint32_t place = put_beat_ * kBeatWords + i;
      if (place < record_.size()) beat[i] = record_[place];
    }
    return beat;
  }
  bool contribution_valid() const { return contributes_ && !contributed_; }
  /// Means something while contribution_valid().
  FrameContribution contribution() const {
    const Ray& ray = rays_[contribution_place_];
    return {ray[word::kPixel], {ray[word::kColor], ray[word::kColor + 1], ray[word::kColor + 2]}};
  }

  /// For reports: of a word of put_data() its number in an intersection, or kNoWord. Means something while put_valid().
  uint32_t put_word(uint32_t number) const { return words_of(frame_.layout)[put_beat_ * kBeatWords + number]; }

  /// The end of a cycle.
  void clock(const Inputs& inputs) {
    const bool moves = fate_ && fate_moves();
    const bool put_free_was = put_free_, contributed_was = contributed_;
    LeafReader::Inputs reader;
    std::optional<Set> unblocked;
    if (moves && finishes()) {
      reader_.start(cycle_, 0, entries_.number(), fate_->hit.place);
      hits_[entries_.number()] = {set_of(*fate_), fate_->hit.t};
      entries_.take();
    } else if (moves && !drops() && !plain()) {
      unblocked = set_of(*fate_);
    }
    const bool plain_goes = moves && plain();
    move_packages(inputs.put_ready);
    move_contributions(inputs.contribution_ready, contributed_was && !put_free_was);
    finish(reader);
    reader.taken = inputs.taken;
    reader.waited = inputs.waited;
    reader.given = inputs.given;
    reader_.clock(cycle_, reader);
    ++cycle_;

    if (unblocked && sizes_.contributes) contributions_.push(unblocked->place);
    if (unblocked && !sizes_.contributes) push_package(ImportKind::Shadow, {unblocked->place});
    if (plain_goes) push_package(ImportKind::Normal, {set_of(*fate_).place, true, fate_->hit.hit});
    if (moves) fate_.reset();
    if (inputs.done != nullptr) {
      done_turn_.advance(inputs.done->lane);
      fate_ = *inputs.done;
    }
    if (inputs.set != nullptr) sets_[inputs.set_slot.lane * sizes_.slots + inputs.set_slot.slot] = *inputs.set;
    if (inputs.ray != nullptr) rays_[inputs.ray_place] = *inputs.ray;
  }

 private:
  struct Hit {
    Set set;
    float t = 0;  ///< internal
  };
  /// What a package carries besides its ray's words.
  struct Finished {
    RayFinish finish;
    uint32_t number = 0, material = 0;
  };

  /// One that waits.
  struct Package {
    uint32_t place = 0;
    bool plain = false;  ///< it has no words of a hit, though it is of a normal ray
    bool met = true;     ///< of a ray that returns: it has met something
  };

  void push_package(ImportKind kind, const Package& package) {
    packages_[to_underlying(kind)].push(package);
    waiting_kinds_ |= 1u << to_underlying(kind);
  }
  const Set& set_of(const Done& done) const { return sets_[done.lane * sizes_.slots + done.slot]; }
  bool plain() const { return fate_->hit.hit ? set_of(*fate_).first : set_of(*fate_).returns; }
  bool drops() const { return set_of(*fate_).shadow == fate_->hit.hit && !plain(); }
  bool finishes() const { return !set_of(*fate_).shadow && fate_->hit.hit && !plain(); }
  bool fate_moves() const {
    if (plain()) return pipe_.result() == nullptr;  // a finished hit goes first
    if (drops()) return !put_free_ && !contributed_;
    return !finishes() || entries_.valid();
  }

  // What has been computed of a hit waits as a package; the next hit that has its triangle is begun.
  void finish(LeafReader::Inputs& reader) {
    if (const RayFinishPipe::Result* const result = pipe_.result()) {
      const auto place = static_cast<uint32_t>(result->tag >> 1);
      finished_[place].finish = result->finish;
      push_package((result->tag & 1) != 0 ? ImportKind::Direct : ImportKind::Normal, {place});
    }
    std::optional<LeafReader::Test> test;
    if (pause_ == 0) test = reader_.test();
    reader.triangle_taken = test.has_value();
    if (!test) {
      pause_ -= static_cast<uint32_t>(pause_ != 0);
      pipe_.clock(nullptr);
      return;
    }
    pause_ = RayFinishPipe::kApart - 1;
    const Hit& hit = hits_[test->slot];
    Finished& finished = finished_[hit.set.place];
    finished.number = test->triangle.number;
    finished.material = test->material;
    const bool reflects = hit.set.depth < frame_.depth && (test->material & kMaterialReflects) != 0;
    const bool direct = sizes_.culling && frame_.reflections && !reflects;
    const RayFinishPipe::Start start{uint64_t{hit.set.place} << 1 | (direct ? 1u : 0u), hit.set.ray, test->triangle,
                                     hit.t, hit.set.scale};
    pipe_.clock(&start);
    entries_.free(test->slot);
  }

  void move_packages(uint32_t ready) {
    put_free_ = false;
    if (puts_) {
      if ((ready >> to_underlying(put_kind_) & 1) == 0 || ++put_beat_ < beats_) return;
      puts_ = false;
      put_free_ = true;
      put_free_place_ = put_package_.place;
      put_free_shadow_ = put_kind_ == ImportKind::Shadow;
      return;
    }
    const uint32_t asking = waiting_kinds_ & ready;
    if (asking == 0) return;
    const uint32_t chosen = kind_turn_.choose(asking);
    kind_turn_.advance(chosen);
    puts_ = true;
    put_beat_ = 0;
    put_kind_ = static_cast<ImportKind>(chosen);
    put_package_ = packages_[chosen].data();
    packages_[chosen].pop();
    waiting_kinds_ ^= (packages_[chosen].valid() ? 0u : 1u) << chosen;
    record_ = packed(package(), frame_.layout);
  }
  Intersection package() const {
    Intersection package{};
    const Ray& ray = rays_[put_package_.place];
    std::copy(ray.begin(), ray.end(), package.begin());
    if (sizes_.miss_records && returns(ray)) set_met(package, put_package_.met);
    if (put_kind_ == ImportKind::Shadow || put_package_.plain) return package;
    const auto& [finish, number, material] = finished_[put_package_.place];
    package[word::kDistance] = as_bits(finish.t);
    package[word::kBarycentric] = as_bits(finish.u);
    package[word::kBarycentric + 1] = as_bits(finish.v);
    for (int axis = 0; axis < 3; ++axis) package[word::kNormal + axis] = as_bits(finish.normal[axis]);
    package[word::kMaterial] = frame_.material_base + (material & 0x7ffffff) * uint32_t{kMaterialBytes};
    package[word::kTriangle] = number;
    return package;
  }

  void move_contributions(bool ready, bool freed) {
    const bool taken = contribution_valid() && ready;
    if (freed) {
      contributes_ = contributed_ = false;
    } else if (!contributes_ && contributions_.valid()) {
      contributes_ = true;
      contribution_place_ = contributions_.data();
      contributions_.pop();
    } else if (taken) {
      contributed_ = true;
    }
  }

  Sizes sizes_;
  uint32_t beats_;  // of a package
  Frame frame_;
  std::vector<Set> sets_;  // [lane][slot]
  RoundRobin done_turn_;
  std::optional<Done> fate_;  // what becomes of it is decided

  FreeList entries_;       // of hits that have their triangle read
  std::vector<Hit> hits_;  // [entry]
  uint64_t cycle_ = 0;
  LeafReader reader_;
  uint32_t pause_ = 0;  // cycles until the next one may be finished
  RayFinishPipe pipe_;

  std::vector<Ray> rays_;                    // [place]
  std::vector<Finished> finished_;           // [place]
  std::vector<RamQueue<Package>> packages_;  // [kind]
  uint32_t waiting_kinds_ = 0;               // of packages
  RoundRobin kind_turn_;
  bool puts_ = false;
  ImportKind put_kind_ = ImportKind::None;
  uint32_t put_beat_ = 0;
  Package put_package_;
  Intersection record_{};
  bool put_free_ = false, put_free_shadow_ = false;  // a package has left in the cycle before
  uint32_t put_free_place_ = 0;

  RamQueue<uint32_t> contributions_;                // places
  bool contributes_ = false, contributed_ = false;  // one is offered, or has been taken; its place is not free
  uint32_t contribution_place_ = 0;
};

}  // namespace raypool
