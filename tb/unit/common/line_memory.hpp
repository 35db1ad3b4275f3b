// A memory for unit benches, at the end of a memory port: takes requests when it likes and answers late, in
// any order of the lines, with gaps and interleaved beats. As the port demands, a read sees every write
// taken before it and none taken after it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <unordered_map>
#include <vector>

namespace raypool::bench {

struct MemoryBehaviour {
  int latency = 10;           ///< cycles from a request to its first beat, at least
  int jitter = 0;             ///< up to this many more
  int ready_percent = 100;    ///< how often a request is taken
  int beat_percent = 100;     ///< how often a beat comes that could come
  bool out_of_order = false;  ///< beats of several lines are mixed
  int gap = 0;          ///< up to so many cycles from a line's last beat to the first of the next; 0: as they come
  bool silent = false;  ///< takes requests, answers nothing
};

class LineMemory {
 public:
  struct Beat {
    uint32_t id = 0;
    uint32_t beat = 0;
    std::array<uint32_t, 4> data{};
  };

  /// There are words at all addresses, each of which holds another value at first; bytes() is how many are meant to be
  /// used.
  LineMemory(size_t words, uint32_t seed) : bytes_(static_cast<uint32_t>(words * 4)), random_(seed) {}

  MemoryBehaviour behaviour;

  uint32_t& word(uint32_t address) { return words_.try_emplace(address / 4, 0x10000000u + address / 4).first->second; }
  uint32_t bytes() const { return bytes_; }

  bool decide_ready() { return percent(behaviour.ready_percent); }

  void read(uint32_t address, uint32_t id, uint64_t cycle) {
    Line line;
    line.id = id;
    line.address = address;
    line.due =
        cycle + static_cast<uint64_t>(behaviour.latency) + random_() % static_cast<uint32_t>(behaviour.jitter + 1);
    for (uint32_t i = 0; i < 16; ++i) line.data[i] = word(address + 4 * i);
    lines_.push_back(line);
    ++reads_;
  }
  void write(uint32_t address, const std::array<uint32_t, 4>& data, uint32_t mask) {
    for (uint32_t i = 0; i < 4; ++i)
      if (mask >> i & 1) word(address + 4 * i) = data[i];
  }

  /// The beat of this cycle.
  std::optional<Beat> respond(uint64_t cycle) {
    if (lines_.empty() || behaviour.silent || !percent(behaviour.beat_percent)) return std::nullopt;
    size_t which = behaviour.out_of_order ? random_() % lines_.size() : 0;
    Line& line = lines_[which];
    if (cycle < line.due || (line.next == 0 && cycle < next_line_)) return std::nullopt;
    Beat beat;
    beat.id = line.id;
    beat.beat = line.next;
    for (uint32_t i = 0; i < 4; ++i) beat.data[i] = line.data[line.next * 4 + i];
    if (++line.next == 4) {
      lines_.erase(lines_.begin() + which);
      if (behaviour.gap > 0) next_line_ = cycle + 1 + random_() % static_cast<uint32_t>(behaviour.gap);
    }
    return beat;
  }

  bool fetching_line(uint32_t address) const {
    for (const Line& line : lines_)
      if (line.address == (address & ~63u)) return true;
    return false;
  }
  bool fetching_id(uint32_t id) const {
    for (const Line& line : lines_)
      if (line.id == id) return true;
    return false;
  }
  size_t reads() const { return reads_; }
  size_t pending() const { return lines_.size(); }

 private:
  struct Line {
    uint32_t id = 0, address = 0, next = 0;
    uint64_t due = 0;
    std::array<uint32_t, 16> data{};
  };

  bool percent(int chance) { return static_cast<int>(random_() % 100) < chance; }

  std::unordered_map<uint32_t, uint32_t> words_;
  uint32_t bytes_;
  uint64_t next_line_ = 0;
  std::vector<Line> lines_;
  std::mt19937 random_;
  size_t reads_ = 0;
};

}  // namespace raypool::bench
