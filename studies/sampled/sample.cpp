#include "sampled/sample.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <stdexcept>

#include "bits.hpp"

namespace raypool::sampled {

Sample::Sample(uint32_t tiles, uint32_t block_tiles, const std::vector<double>& sizes, uint32_t strata, uint64_t seed)
    : tiles_(tiles), block_tiles_(block_tiles), blocks_(blocks_of(tiles, block_tiles)), strata_(strata) {
  if (strata == 0 || strata > most_strata(tiles_, block_tiles)) throw std::logic_error("a stratum of too few blocks");
  if (sizes.size() != blocks_) throw std::logic_error("not a size of each block");
  std::vector<uint32_t> inner(inner_blocks());
  std::iota(inner.begin(), inner.end(), 1);
  std::stable_sort(inner.begin(), inner.end(), [&](uint32_t a, uint32_t b) { return sizes[a] < sizes[b]; });
  std::mt19937_64 random(seed);
  for (uint32_t i = 0; i < strata; ++i) {
    const auto edge = [&](uint32_t stratum) {
      return inner.begin() + static_cast<std::ptrdiff_t>(uint64_t{stratum} * inner.size() / strata);
    };
    strata_[i].order.assign(edge(i), edge(i + 1));
    std::shuffle(strata_[i].order.begin(), strata_[i].order.end(), random);
  }
}

std::vector<uint32_t> Sample::draw(uint32_t inner) {
  std::vector<uint32_t> blocks;
  for (Stratum& stratum : strata_) {
    const auto all = size32(stratum.order);
    const auto share = static_cast<uint32_t>((uint64_t{inner} * all + inner_blocks() / 2) / inner_blocks());
    for (const uint32_t wanted = std::min(all, std::max(kLeastDrawn, share)); stratum.drawn < wanted; ++stratum.drawn)
      blocks.push_back(stratum.order[stratum.drawn]);
  }
  std::sort(blocks.begin(), blocks.end());
  return blocks;
}

uint32_t Sample::drawn() const {
  return std::accumulate(strata_.begin(), strata_.end(), 0u,
                         [](uint32_t sum, const Stratum& stratum) { return sum + stratum.drawn; });
}

}  // namespace raypool::sampled
