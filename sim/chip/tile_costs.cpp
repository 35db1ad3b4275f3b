#include "chip/tile_costs.hpp"

namespace raypool::chip {

// While no pixel is held counts wait for the next one; what is left at the end is the last tile's.
void TileCosts::share(const Counts& now) {
  if (held_ == 0) return;
  for (size_t i = 0; i < now.size(); ++i) a_pixel_[i] += (now[i] - last_[i]) / held_;
  last_ = now;
}

uint32_t TileCosts::cast(uint32_t pixels, const Counts& now) {
  share(now);
  held_ += pixels;
  Counts cost;
  for (size_t i = 0; i < cost.size(); ++i) cost[i] = -a_pixel_[i] * pixels;
  costs_.push_back(cost);
  return static_cast<uint32_t>(costs_.size() - 1);
}

void TileCosts::finished(uint32_t tile, const Counts& now) {
  share(now);
  --held_;
  for (size_t i = 0; i < now.size(); ++i) costs_[tile][i] += a_pixel_[i];
}

void TileCosts::end(const Counts& now) {
  if (costs_.empty()) return;
  for (size_t i = 0; i < now.size(); ++i) costs_.back()[i] += now[i] - last_[i];
  last_ = now;
}

}  // namespace raypool::chip
