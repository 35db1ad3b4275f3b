#include "machine/ray_slices.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace raypool {

RaySlices::RaySlices(int warps, int lanes) : lanes_(static_cast<uint32_t>(lanes)) {
  warps_.resize(static_cast<size_t>(warps));
  reset();
}

void RaySlices::reset() {
  words_.assign(warps_.size() * 3 * kIntersectionWords * lanes_, 0);
  for (Warp& warp : warps_) warp = Warp{};
  jobs_.clear();
  beats_ = 0;
}

void RaySlices::expect_import(uint32_t threads) { jobs_.push_back({threads, 0}); }

void RaySlices::import_package(const Intersection& package) {
  if (jobs_.empty()) throw std::logic_error("an import package came that no launch has asked for");
  Job& job = jobs_.front();
  const uint32_t lane = job.taken % lanes_;
  Warp& warp = warps_[job.taken / lanes_];
  if (lane == 0)
    warp.inputs.push_back(
        {std::min(lanes_, job.threads - job.taken), 0, std::vector<uint32_t>(lanes_ * kIntersectionWords)});
  Input& input = warp.inputs.back();
  for (uint32_t word = 0; word < kIntersectionWords; ++word) input.words[word * lanes_ + lane] = package[word];
  ++input.taken;
  if (++job.taken == job.threads) jobs_.pop_front();
}

void RaySlices::import_beat(const Beat& beat) {
  package_[beats_] = beat;
  if (++beats_ < kIntersectionBeats) return;
  beats_ = 0;
  Intersection package;
  std::memcpy(package.data(), package_.data(), sizeof(package));
  import_package(package);
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
  for (uint32_t word = 0; word < kIntersectionWords; ++word) {
    std::memcpy(row(number, warp.input, word), &input.words[word * lanes_], input.lanes * sizeof(uint32_t));
  }
  warp.inputs.pop_front();
  std::swap(warp.input, warp.current);
}

void RaySlices::swap_output(uint32_t number) { std::swap(warps_[number].current, warps_[number].output); }

}  // namespace raypool
