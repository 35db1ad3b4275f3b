#include "traverser/tree_memory.hpp"

#include <algorithm>

namespace raypool::traverser {

namespace {

constexpr uint32_t kLineBytes = 64, kLineBeats = 4, kBeatBytes = 16, kEntryBytes = 8, kSources = 3;
constexpr uint32_t kSpillBeats = kSpillEntries * kEntryBytes / kBeatBytes;
// Where nodes, triangles and stacks lie: lines.
constexpr uint64_t kTriangles = 1ull << 32, kStacks = 2ull << 32, kStackLines = 64;

}  // namespace

TreeMemory::TreeMemory(const ChipConfiguration& chip, MemoryTurns& turns)
    : turns_(turns),
      latency_(chip.memory_latency),
      row_miss_(chip.modelled_traverser_memory_row_miss),
      lines_a_row_(chip.modelled_traverser_memory_row_bytes / kLineBytes),
      lines_a_node_(node_bytes(chip.modelled_traverser_nodes) / kLineBytes),
      banks_(chip.modelled_traverser_memory_banks) {}

uint64_t TreeMemory::access(uint64_t line, uint64_t start) {
  const uint64_t row = line / lines_a_row_;
  Bank& bank = banks_[row % banks_.size()];
  const bool hit = bank.row == row;
  ++(hit ? row_hits_ : row_misses_);
  bank.row = row;
  bank.free_from = std::max(start, bank.free_from) + (hit ? 0 : row_miss_);
  return bank.free_from;
}

uint64_t TreeMemory::read_lines(uint64_t cycle, uint64_t line, uint64_t lines, Returned returned) {
  uint64_t due = 0;
  for (const uint64_t end = line + lines; line < end; ++line) {
    ++reads_;
    const uint64_t start = turns_.turn(cycle, kLineBeats);
    due = turns_.line(start, access(line, start) + latency_);
  }
  lines_.push_back({due, returned});
  return due;
}

uint64_t TreeMemory::read(uint64_t cycle, Source source, uint32_t line, uint32_t which) {
  return source == Source::Nodes ? read_lines(cycle, line * lines_a_node_, lines_a_node_, {source, which})
                                 : read_lines(cycle, kTriangles + line, 1, {source, which});
}

// A block of entries shares its line with the one after it.
void TreeMemory::serve_stack(uint64_t cycle, const RayStacks::Request& request) {
  const uint64_t line = kStacks + request.slot * kStackLines + request.block / 2;
  if (request.write) {
    quadwords_ += kSpillBeats;
    access(line, turns_.turn(cycle, kSpillBeats));
  } else {
    read_lines(cycle, line, 1, {Source::Stacks, request.slot});
  }
}

void TreeMemory::serve(uint64_t cycle, FetchUnit& nodes, FetchUnit& triangles, RayStacks& stacks,
                       LookupListener& listener) {
  for (uint32_t i = 0; i < kSources; ++i) {
    const auto source = static_cast<Source>((next_source_ + i) % kSources);
    FetchUnit& fetch = source == Source::Nodes ? nodes : triangles;
    if (source == Source::Stacks ? !stacks.request_valid() : !fetch.request_valid()) continue;
    next_source_ = (static_cast<uint32_t>(source) + 1) % kSources;
    if (source == Source::Stacks) {
      serve_stack(cycle, stacks.take_request());
    } else {
      const uint32_t line = fetch.take_request();
      fetch.promise(line, read(cycle, source, line, line), listener);
    }
    return;
  }
}

TreeMemory::Returned TreeMemory::take() {
  const Returned returned = lines_.front().returned;
  lines_.pop_front();
  return returned;
}

void TreeMemory::add_to(TraverserWork& work) const {
  work.memory_lines = reads_;
  work.memory_quadwords = quadwords_;
  work.row_hits = row_hits_;
  work.row_misses = row_misses_;
}

}  // namespace raypool::traverser
