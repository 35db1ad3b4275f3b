#include "kernel/record_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <climits>

#include "isa/input_error.hpp"
#include "kernel/compiler.hpp"

namespace raypool::kernel {
namespace {

/// What a kernel does with the package that it imports.
struct Use {
  uint32_t needed = 0;  // words, a bit each
  bool loops = false;
  std::array<int, kIntersectionWords> first_write, last_read;  // [word] number of the op

  Use() {
    first_write.fill(INT_MAX);
    last_read.fill(-1);
  }
  /// The hit's word may lie where that of the ray has its place.
  bool may_share(size_t ray_word, size_t hit_word) const {
    return !loops && last_read[hit_word] < first_write[ray_word];
  }
};

constexpr uint32_t bits_of(int first, int count) { return ((1u << count) - 1) << first; }

Use use_of(Function kernel) {
  remove_dead(kernel);
  Use use;
  bool imported = false;  // the current slice is the package's
  uint32_t written = 0;   // in all lanes
  for (size_t i = 0; i < kernel.ops.size(); ++i) {
    const Op& op = kernel.ops[i];
    use.loops |= op.kind == Op::Kind::LoopEnd;
    if (is(op, Opcode::Rin)) imported = true;
    if (!imported) continue;
    if (is(op, Opcode::Rld)) {
      use.needed |= 1u << op.word & ~written;
      use.last_read[op.word] = static_cast<int>(i);
    } else if (is(op, Opcode::Rst)) {
      if (op.guard.all()) written |= 1u << op.word;
      use.first_write[op.word] = std::min(use.first_write[op.word], static_cast<int>(i));
    } else if (is(op, Opcode::Rout) || is(op, Opcode::Rfb)) {
      use.needed |= (is(op, Opcode::Rout) ? bits_of(0, kRayWords) : bits_of(word::kPixel, 4)) & ~written;
      imported = false;
    }
  }
  return use;
}

}  // namespace

RecordLayout compact_layout(const std::vector<Function>& kernels) {
  std::vector<Use> uses;
  uint32_t needed = 0;
  for (const Function& kernel : kernels) {
    uses.push_back(use_of(kernel));
    needed |= uses.back().needed;
  }
  RecordLayout layout;
  layout.words = kRayWords;
  layout.place.fill(RecordLayout::kAbsent);
  uint32_t free = bits_of(0, kRayWords) & ~needed;
  for (size_t word = 0; word < kIntersectionWords; ++word) {
    if ((needed >> word & 1) == 0) continue;
    uint32_t place = word < kRayWords ? static_cast<uint32_t>(word) : layout.words;
    for (uint32_t shared = 0; word >= kRayWords && shared < kRayWords; ++shared) {
      const auto may = [&](const Use& use) { return use.may_share(shared, word); };
      if ((free >> shared & 1) == 0 || !std::all_of(uses.begin(), uses.end(), may)) continue;
      place = shared;
      free &= ~(1u << shared);
      break;
    }
    layout.place[word] = static_cast<uint8_t>(place);
    layout.words = std::max(layout.words, place + 1);
  }
  return layout;
}

void place_words(Function& kernel, const RecordLayout& layout) {
  const auto lacks = [&](const Op& op) {
    return is(op, Opcode::Rld) && op.word >= kRayWords && layout.place.at(op.word) == RecordLayout::kAbsent;
  };
  // Words that nothing uses are not needed and have no place in the layout.
  if (std::any_of(kernel.ops.begin(), kernel.ops.end(), lacks)) remove_dead(kernel);
  kernel.slice_words = static_cast<int>(layout.words);
  for (Op& op : kernel.ops) {
    if (!(is(op, Opcode::Rld) || is(op, Opcode::Rst)) || op.word < kRayWords) continue;
    const uint8_t place = layout.place.at(op.word);
    if (place == RecordLayout::kAbsent)
      throw InputError(
          fmt::format("{}: ray word {} is not in the compact record", to_string(op.where), static_cast<int>(op.word)));
    op.word = place;
  }
}

}  // namespace raypool::kernel
