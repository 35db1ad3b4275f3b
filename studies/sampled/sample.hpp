// Which tiles of a picture are simulated: a stratified random sample of runs of tiles along the walk in which they are
// cast.
//
// The walk is cut into blocks of tiles. The first and the last block, in which the chip fills and drains, are always
// simulated. Those between are put in the order of a size that is known of all of them, and along the walk where that
// is the same, and cut into strata, in each of which they are alike. Of each stratum blocks are drawn at random,
// without replacement. So what is rare and dear has a stratum of its own, and is never left out.
#pragma once

#include <cstdint>
#include <vector>

namespace raypool::sampled {

inline constexpr uint32_t kLeastDrawn = 3;  ///< blocks of each stratum: of fewer the variance is known too badly

/// Blocks that are alike, of which some are drawn.
struct Stratum {
  std::vector<uint32_t> order;  ///< its blocks, in the random order in which they are drawn
  uint32_t drawn = 0;           ///< of these
};

class Sample {
 public:
  /// Of so many tiles, along the walk, in blocks of `block_tiles`, which have these sizes; so many strata, each of
  /// kLeastDrawn blocks or more: see most_strata().
  Sample(uint32_t tiles, uint32_t block_tiles, const std::vector<double>& sizes, uint32_t strata, uint64_t seed);

  /// Blocks of such a picture.
  static uint32_t blocks_of(uint32_t tiles, uint32_t block_tiles) { return (tiles + block_tiles - 1) / block_tiles; }

  /// So many strata can be made; 0: none.
  static uint32_t most_strata(uint32_t tiles, uint32_t block_tiles) {
    const uint32_t all = blocks_of(tiles, block_tiles);
    return all < 2 ? 0 : (all - 2) / kLeastDrawn;
  }

  uint32_t blocks() const { return blocks_; }
  /// Those that are not simulated always.
  uint32_t inner_blocks() const { return blocks_ - 2; }
  /// Tiles begin(block) .. begin(block + 1) - 1 are the block's.
  uint32_t begin(uint32_t block) const { return block < blocks_ ? block * block_tiles_ : tiles_; }

  /// Draws until so many inner blocks are drawn, of each stratum its share and at least kLeastDrawn. Returns the new
  /// ones, ascending.
  std::vector<uint32_t> draw(uint32_t inner_blocks);
  uint32_t drawn() const;
  const std::vector<Stratum>& strata() const { return strata_; }

 private:
  uint32_t tiles_, block_tiles_, blocks_;
  std::vector<Stratum> strata_;
};

}  // namespace raypool::sampled
