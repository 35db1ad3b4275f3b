#include "machine/compute/ray_slices.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace raypool {

RaySlices::RaySlices(uint32_t warps, uint32_t lanes, uint32_t words)
    : lanes_(lanes), word_count_(words), beats_((words + kBeatWords - 1) / kBeatWords) {
  warps_.resize(warps);
  reset();
}

void RaySlices::reset() {
  words_.assign(warps_.size() * 3 * word_count_ * lanes_, 0);
  for (Warp& warp : warps_) warp = Warp{};
  jobs_.clear();
  arriving_beat_ = 0;
}

void RaySlices::expect_import(uint32_t threads) { jobs_.push_back({threads, 0}); }

// A package begins to arrive.
void RaySlices::package_start() {
  if (jobs_.empty()) throw std::logic_error("an import package came that no launch has asked for");
  const Job& job = jobs_.front();
  arriving_warp_ = job.taken / lanes_;
  if (job.taken % lanes_ != 0) return;
  warps_[arriving_warp_].inputs.push_back(
      {std::min(lanes_, job.threads - job.taken), 0, std::vector<uint32_t>(beats_ * kBeatWords * lanes_)});
}

void RaySlices::package_end(Input& input) {
  ++input.taken;
  if (++jobs_.front().taken == jobs_.front().threads) jobs_.pop_front();
}

void RaySlices::import_package(const Intersection& package) {
  package_start();
  Input& input = warps_[arriving_warp_].inputs.back();
  for (uint32_t word = 0; word < word_count_; ++word) input.words[word * lanes_ + input.taken] = package[word];
  package_end(input);
}

void RaySlices::import_beat(const Beat& beat) {
  if (arriving_beat_ == 0) package_start();
  Input& input = warps_[arriving_warp_].inputs.back();
  uint32_t* word = &input.words[arriving_beat_ * kBeatWords * lanes_ + input.taken];
  for (uint32_t i = 0; i < kBeatWords; ++i, word += lanes_) *word = beat[i];
  if (++arriving_beat_ < beats_) return;
  arriving_beat_ = 0;
  package_end(input);
}

uint32_t RaySlices::packages_expected() const {
  uint32_t sum = 0;
  for (const Job& job : jobs_) sum += job.threads - job.taken;
  return sum;
}

void RaySlices::swap_input(uint32_t number) {
  Warp& warp = warps_[number];
  const Input& input = warp.inputs.front();
  // Lanes without a package keep what the slice held, as in the RTL.
  for (uint32_t word = 0; word < word_count_; ++word) {
    std::memcpy(row(number, warp.input, word), &input.words[word * lanes_], input.lanes * sizeof(uint32_t));
  }
  warp.inputs.pop_front();
  std::swap(warp.input, warp.current);
}

void RaySlices::swap_output(uint32_t number) { std::swap(warps_[number].current, warps_[number].output); }

}  // namespace raypool
