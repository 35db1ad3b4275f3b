// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Local ray memory as the architecture sees it: three slices a warp that change roles, and the
// packages that wait to become current.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "machine/common/packages.hpp"

namespace raypool {

class RaySlices {
 public:
  /// Of slices with so many words a thread, which are those of a package.
  RaySlices(uint32_t warps, uint32_t lanes, uint32_t words = kIntersectionWords);
  void reset();

  /// A launch will import packages for `threads` threads; they go to warps in order once earlier launches have theirs.
  void expect_import(uint32_t threads);
  /// The next package. One that is not expected is an error of the caller: std::logic_error.
  void import_package(const Intersection& package);
  /// The next beat of one.
  void import_beat(const Beat& beat);
  /// Packages that were announced and have not come.
  uint32_t packages_expected() const;

  /// True if all packages of the warp's next `rin` are there.
  bool input_complete(uint32_t warp) const {
    return !warps_[warp].inputs.empty() && warps_[warp].inputs.front().complete();
  }
  /// Sets of packages, complete or arriving, that wait for a `rin` of the warp.
  size_t inputs_waiting(uint32_t warp) const { return warps_[warp].inputs.size(); }

  /// `rin`: the packages get into the input slice, then input and current swap. input_complete() must hold.
  void swap_input(uint32_t warp);
  /// `rout`, `rfb`: current and output swap.
  void swap_output(uint32_t warp);

  /// Word `word` of all lanes of a slice.
  uint32_t* current(uint32_t warp, uint32_t word) { return row(warp, warps_[warp].current, word); }
  const uint32_t* output(uint32_t warp, uint32_t word) const { return row(warp, warps_[warp].output, word); }
  /// Four words of one lane, from `word` on.
  Beat output_beat(uint32_t warp, uint32_t word, uint32_t lane) const {
    const uint32_t* from = row(warp, warps_[warp].output, word) + lane;
    return {from[0], from[lanes_], from[2 * lanes_], from[3 * lanes_]};
  }

 private:
  struct Input {
    uint32_t lanes = 0;  ///< packages it will hold
    uint32_t taken = 0;
    std::vector<uint32_t> words;  ///< [word][lane], with the zeros of the last beat
    bool complete() const { return taken == lanes; }
  };
  struct Warp {
    uint8_t input = 0, current = 1, output = 2;
    std::deque<Input> inputs;
  };
  struct Job {
    uint32_t threads, taken;
  };

  void package_start();
  void package_end(Input& input);

  uint32_t* row(uint32_t warp, uint32_t slice, uint32_t word) {
    return &words_[((warp * 3 + slice) * word_count_ + word) * lanes_];
  }
  const uint32_t* row(uint32_t warp, uint32_t slice, uint32_t word) const {
    return &words_[((warp * 3 + slice) * word_count_ + word) * lanes_];
  }

  uint32_t lanes_, word_count_;
  uint32_t beats_;               ///< of a package
  std::vector<uint32_t> words_;  ///< [warp][slice][word][lane]
  std::vector<Warp> warps_;
  std::deque<Job> jobs_;
  uint32_t arriving_warp_ = 0, arriving_beat_ = 0;  ///< of the package that arrives
};

}  // namespace raypool
