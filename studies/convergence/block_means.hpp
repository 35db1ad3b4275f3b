// Means of a picture's square blocks over many samples, and how far they scatter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace raypool::convergence {

/// Of a picture, or of one sample of it: red, green and blue of each block.
using BlockMeans = std::vector<double>;

/// The means of a picture whose pixels' channels are these; blocks at the right and lower edge may be smaller.
BlockMeans block_means(uint32_t width, uint32_t height, uint32_t block,
                       const std::function<double(uint32_t x, uint32_t y, uint32_t channel)>& value);

/// Mean and variance of numbers as they come.
class Spread {
 public:
  void add(double number);
  uint64_t count() const { return count_; }
  double mean() const { return mean_; }
  double variance() const { return count_ < 2 ? 0 : squares_ / static_cast<double>(count_ - 1); }
  /// Of the mean, its standard error squared.
  double variance_of_mean() const { return count_ == 0 ? 0 : variance() / static_cast<double>(count_); }

 private:
  uint64_t count_ = 0;
  double mean_ = 0, squares_ = 0;
};

/// What samples of a picture come to: each block's colours, its brightness, and those of the whole picture.
class PictureSpread {
 public:
  void add(const BlockMeans& sample);
  const std::vector<Spread>& channels() const { return channels_; }  ///< [3 block + channel]
  const std::vector<Spread>& blocks() const { return blocks_; }      ///< brightness: the mean of the channels
  const Spread& whole() const { return whole_; }                     ///< brightness

 private:
  std::vector<Spread> channels_, blocks_;
  Spread whole_;
};

/// Variance, over pictures of N samples each, of what samples add that come one after the other.
class VarianceOfPictures {
 public:
  explicit VarianceOfPictures(uint32_t samples) : samples_(samples) {}
  void add(const BlockMeans& sample);
  uint32_t samples() const { return samples_; }
  uint64_t pictures() const { return spread_.whole().count(); }
  /// Mean over blocks and channels of the variance, each divided by the square of `means`; those of zero left out.
  double relative(const PictureSpread& means) const;

 private:
  uint32_t samples_, added_ = 0;
  BlockMeans sum_;
  PictureSpread spread_;
};

}  // namespace raypool::convergence
