#include "convergence/block_means.hpp"

#include <algorithm>

namespace raypool::convergence {

BlockMeans block_means(uint32_t width, uint32_t height, uint32_t block,
                       const std::function<double(uint32_t, uint32_t, uint32_t)>& value) {
  const uint32_t columns = (width + block - 1) / block, rows = (height + block - 1) / block;
  BlockMeans means(size_t{3} * columns * rows);
  for (uint32_t y = 0; y < height; ++y) {
    for (uint32_t x = 0; x < width; ++x) {
      const uint32_t row = y / block, column = x / block;
      const double pixels =
          static_cast<double>(std::min(block, width - column * block)) * std::min(block, height - row * block);
      for (uint32_t channel = 0; channel < 3; ++channel)
        means[size_t{3} * (row * columns + column) + channel] += value(x, y, channel) / pixels;
    }
  }
  return means;
}

void Spread::add(double number) {
  ++count_;
  const double off = number - mean_;
  mean_ += off / static_cast<double>(count_);
  squares_ += off * (number - mean_);
}

void PictureSpread::add(const BlockMeans& sample) {
  channels_.resize(sample.size());
  blocks_.resize(sample.size() / 3);
  double whole = 0;
  for (size_t i = 0; i < blocks_.size(); ++i) {
    double sum = 0;
    for (size_t channel = 0; channel < 3; ++channel) {
      channels_[3 * i + channel].add(sample[3 * i + channel]);
      sum += sample[3 * i + channel];
    }
    blocks_[i].add(sum / 3);
    whole += sum / 3;
  }
  whole_.add(whole / static_cast<double>(blocks_.size()));
}

void VarianceOfPictures::add(const BlockMeans& sample) {
  sum_.resize(sample.size());
  for (size_t i = 0; i < sample.size(); ++i) sum_[i] += sample[i] / samples_;
  if (++added_ < samples_) return;
  spread_.add(sum_);
  sum_.assign(sample.size(), 0);
  added_ = 0;
}

double VarianceOfPictures::relative(const PictureSpread& means) const {
  Spread mean;
  for (size_t i = 0; i < spread_.channels().size(); ++i) {
    const double value = means.channels()[i].mean();
    if (value > 0) mean.add(spread_.channels()[i].variance() / (value * value));
  }
  return mean.mean();
}

}  // namespace raypool::convergence
