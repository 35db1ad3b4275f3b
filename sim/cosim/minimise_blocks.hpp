// What takes pieces out of something that fails, so long as it fails.
#pragma once

#include <algorithm>
#include <cstddef>

namespace raypool {

/// Takes blocks out of a sequence: halves of it, quarters, and so on to single entries; what cannot go is stepped over.
/// `size()`: of what is left. `without(from, count)`: tries it; true if they are gone. `ends()`: no more is tried.
/// True if anything is gone.
template <typename Size, typename Without, typename Ends>
bool minimise_blocks(Size size, Without without, Ends ends) {
  bool any = false;
  for (size_t block = std::max<size_t>(1, size() / 2);; block /= 2) {
    for (size_t from = 0; from < size() && !ends();) {
      if (without(from, block))
        any = true;
      else
        from += block;
    }
    if (block == 1) return any;
  }
}

}  // namespace raypool
