// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/compute/rp_dispatcher.v: gives every free ALU instance the lowest warp that wants its type, of those that go
// first if there are some, and keeps the task registers behind it.
#pragma once

#include <array>
#include <cstdint>

#include "bits.hpp"
#include "config/configuration.hpp"
#include "enum_array.hpp"
#include "isa/encoding.hpp"
#include "machine/compute/alu_pipeline.hpp"
#include "machine/compute/performance_counters.hpp"
#include "machine/compute/task_register.hpp"
#include "machine/compute/timeline.hpp"

namespace raypool {

class Dispatcher {
 public:
  static constexpr size_t kMostInstances = 4;

  explicit Dispatcher(const Configuration& configuration) {
    for (size_t type = 0; type < kAluTypes; ++type) {
      instances_[type] = static_cast<uint32_t>(configuration.alus[type].count);
      pipelines_[type].fill(AluPipeline(configuration.task_of(static_cast<AluType>(type))));
    }
  }

  void reset() {
    want_types_ = 0;
    want_.fill(0);
    followed_ = 0;
    for (TaskRegister& task : task_) task.clear();
    for (auto& pipelines : pipelines_) {
      for (AluPipeline& pipeline : pipelines) pipeline.reset();
    }
  }

  uint32_t instances(size_t type) const { return instances_[type]; }
  uint32_t depth(size_t type) const { return pipelines_[type][0].depth(); }
  /// The warp with a task that arrives at Mem or Ray in this cycle, or -1.
  int task(AluType type) const { return task_[type].warp(); }
  uint32_t wants(AluType type) const { return want_[type]; }
  bool wants_pipelined() const { return want_types_ != 0; }
  bool idle() const {
    return (want_types_ | wants(AluType::Mem) | wants(AluType::Ray)) == 0 && task(AluType::Mem) < 0 &&
           task(AluType::Ray) < 0;
  }

  /// The warp wants a pipelined type from the cycle of the next grant_pipelined() on.
  void want(size_t type, uint32_t warp) {
    want_[type] |= 1u << warp;
    want_types_ |= 1u << type;
  }
  /// As want(), the first element of a triple; `depend`: its elements wait for each other.
  void want_triple(size_t type, uint32_t warp, bool depend) {
    want(type, warp);
    followed_ |= 1u << warp;
    triples_[warp] = {static_cast<uint8_t>(type), kElements - 1, depend};
  }
  /// The next element of these warps' triples.
  void want_again(uint32_t warps) {
    for (; warps != 0; warps &= warps - 1) want(triples_[lowest(warps)].type, lowest(warps));
  }
  /// Warps that want Mem or Ray from this cycle on.
  void want(AluType type, uint32_t warps) { want_[type] |= warps; }

  /// The grants of a cycle among the pipelined types.
  void grant_pipelined(uint64_t cycle, uint32_t first, Timeline& timeline, PerformanceCounters& counters) {
    for (uint32_t types = want_types_; types != 0; types &= types - 1) {
      const uint32_t type = lowest(types);
      uint32_t want = want_[type];
      for (uint32_t i = 0; i < instances_[type] && want != 0; ++i) {
        AluPipeline& pipeline = pipelines_[type][i];
        if (!pipeline.ready(cycle)) continue;
        const uint64_t done = pipeline.grant(cycle);
        const uint32_t bit = winner(want, first);
        if ((followed_ & bit) == 0)
          timeline.at(done).done |= bit;
        else
          grant_element(lowest(bit), cycle, done, timeline, counters);
        want &= ~bit;
        counters.unready[type] += pipeline.pause();
        ++counters.issued[type];
      }
      want_[type] = want;
      if (want == 0) want_types_ &= ~(1u << type);
      counters.waiting[type] += popcount(want);
    }
  }
  /// Of the warps that want the same, the one that gets it, as a bit.
  static uint32_t winner(uint32_t want, uint32_t first) {
    return lowest_bit((want & first) != 0 ? want & first : want);
  }
  /// The grant of a cycle to Mem or Ray, which decide themselves whether they take a task; some warp wants it.
  void grant(AluType alu, bool ready, uint32_t first, PerformanceCounters& counters) {
    const size_t type = static_cast<size_t>(alu);
    uint32_t& want = want_[type];
    if (ready) {
      const uint32_t bit = winner(want, first);
      task_[type].grant(lowest(bit));
      want &= ~bit;
      ++counters.issued[type];
    }
    counters.waiting[type] += popcount(want);
  }
  /// The task has arrived.
  void arrived(AluType type) { task_[type].clear(); }
  /// From the next cycle on nothing is granted.
  void halt() { want_types_ = 0; }

  /// How many cycles from this one on instances of the type are not ready, as far as is known.
  uint64_t unready(size_t type, uint64_t cycle) const {
    uint64_t sum = 0;
    for (uint32_t i = 0; i < instances_[type]; ++i) sum += pipelines_[type][i].unready(cycle);
    return sum;
  }

 private:
  struct Triple {
    uint8_t type = 0, left = 0;  // elements behind the one that is wanted
    bool depend = false;
  };

  void grant_element(uint32_t warp, uint64_t cycle, uint64_t done, Timeline& timeline, PerformanceCounters& counters) {
    Triple& triple = triples_[warp];
    timeline.at(done).part |= 1u << warp;
    timeline.at(triple.depend ? done : cycle).again |= 1u << warp;
    counters.single[counter::kFltOverlapped] += !triple.depend;
    if (--triple.left == 0) followed_ &= ~(1u << warp);
  }

  uint32_t want_types_ = 0;                         // pipelined types that warps want
  EnumArray<AluType, uint32_t, kAluTypes> want_{};  // [type] those warps
  std::array<uint32_t, kAluTypes> instances_{};
  std::array<std::array<AluPipeline, kMostInstances>, kAluTypes> pipelines_{};
  EnumArray<AluType, TaskRegister, kAluTypes> task_;  // [type] of Mem and Ray
  uint32_t followed_ = 0;                     // warps with a task that is followed by the next element of its triple
  std::array<Triple, kMostWarps> triples_{};  // [warp] of pipelined types
};

}  // namespace raypool
