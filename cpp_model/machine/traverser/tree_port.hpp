// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// rtl/traverser/rp_tree_port.v: the traverser's side of its memory: requests of nodes, triangles and stacks in
// rotation, and lines that come back in the order of the reads. What lies beyond the tree is a fault.
//
// request(), fault() and line() hold in a whole cycle. choose() returns the source of the request that is taken in it,
// then clock() ends it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "machine/common/memory_line.hpp"
#include "machine/common/ram_queue.hpp"
#include "machine/common/round_robin.hpp"
#include "machine/traverser/lane_stacks.hpp"
#include "machine/traverser/leaf_reader.hpp"
#include "machine/traverser/tree_fault.hpp"

namespace raypool {

class TreePort {
 public:
  enum class Source : uint8_t { Nodes, Triangles, Stacks };
  static constexpr uint32_t kEntryWords = 2, kBlockWords = kEntryWords * LaneStacks::kBlock;
  static constexpr uint32_t kBlockBits = 7;  ///< of a block's number in a slot's stack

  /// Where what lies in the memory begins: lines. Nodes are those from 0 to the triangles.
  struct Places {
    uint32_t triangles = 0, stacks = 0;
    uint32_t triangle_lines = 0;
  };
  /// A request that is taken over.
  struct Asked {
    Source source = Source::Nodes;
    uint32_t line = 0, id = 0;                   ///< of a cache
    uint32_t lane = 0;                           ///< of stacks, with the request
    const LaneStacks::Request* stack = nullptr;  ///< else null
  };
  /// A line that has come.
  struct Line {
    Source source = Source::Nodes;
    uint32_t id = 0;  ///< of a cache's request; of stacks the lane
    bool second = false;
    TreeLine data{};

    /// Of keys of so many bits, whatever lies in the memory.
    LaneStacks::Block block(int key_bits) const {
      LaneStacks::Block block;
      for (uint32_t i = 0; i < block.size(); ++i) {
        const uint32_t word = (second ? kBlockWords : 0) + kEntryWords * i;
        block[i] = {data[word + 1] & ((1u << key_bits) - 1), data[word]};
      }
      return block;
    }
  };

  /// `lines`: that may be on their way. `slot_bits`: of a slot's number in its lane.
  TreePort(uint32_t lines, uint32_t slot_bits) : slot_bits_(slot_bits), on_way_(lines) {}

  void set_places(const Places& places) { places_ = places; }

  bool request_valid() const { return request_.has_value(); }
  const TreeRequest& request() const { return *request_; }  ///< only while request_valid()
  const TreeFault& fault() const { return fault_; }         ///< valid for a cycle
  const std::optional<Line>& line() const { return line_; }
  uint64_t lines_read() const { return lines_read_; }
  uint64_t blocks_written() const { return blocks_written_; }

  /// Of those that ask, lanes with a bit each, the source of the request that is taken over, if there is room for one.
  /// `stop`: none, from the cycle after a fault on.
  std::optional<Source> choose(bool request_taken, bool nodes, bool triangles, uint32_t stacks, bool stop) {
    const uint32_t asking = (nodes ? 1u : 0u) | (triangles ? 2u : 0u) | (stacks != 0 ? 4u : 0u);
    if ((request_ && !request_taken) || fault_.valid || stop || asking == 0) return {};
    const uint32_t chosen = turn_.choose(asking);
    turn_.advance(chosen);
    if (chosen == 2) {
      lane_ = stack_turn_.choose(stacks);
      stack_turn_.advance(lane_);
    }
    return static_cast<Source>(chosen);
  }
  uint32_t lane() const { return lane_; }  ///< with the stack's request that has been chosen

  /// The end of a cycle. `asked`: null, none has been chosen. A line is taken before the last beat of the next one.
  void clock(bool request_taken, const Asked* asked, bool line_taken, const Beat* beat) {
    if (request_taken) request_.reset();
    if (line_taken) line_.reset();
    if (beat != nullptr) take_beat(*beat);
    fault_.valid = false;
    if (asked != nullptr) take_request(*asked);
  }

 private:
  struct OnWay {
    Source source;
    uint32_t id;
    bool second;
  };
  static constexpr uint32_t kLine = MemoryLine::kBytes;
  static constexpr uint32_t kLastLine = LeafReader::kLastLine;
  static constexpr uint32_t kLastBlock = (1u << kBlockBits) - 1;  // with it a stack would have as many as none

  // True: nothing of it is requested.
  bool faults(TreeFaultCode code, uint32_t line) {
    fault_ = {true, code, std::min(line, kLastLine)};
    return true;
  }
  bool beyond(const Asked& asked) {
    if (asked.source == Source::Stacks) {
      const LaneStacks::Request& stack = *asked.stack;
      const uint32_t slot = asked.lane << slot_bits_ | stack.slot;
      return stack.write && stack.block == kLastBlock &&
             faults(TreeFaultCode::StackFull, places_.stacks + ((slot << kBlockBits | stack.block) >> 1));
    }
    if (asked.source == Source::Nodes)
      return asked.line >= places_.triangles && faults(TreeFaultCode::NodeBeyond, asked.line);
    return asked.line >= places_.triangle_lines &&
           faults(TreeFaultCode::TriangleBeyond, places_.triangles + asked.line);
  }

  void take_beat(const Beat& beat) {
    std::copy(beat.begin(), beat.end(), coming_.begin() + beat_ * kBeatWords);
    beat_ = (beat_ + 1) % MemoryLine::kBeats;
    if (beat_ != 0) return;
    const OnWay& of = on_way_.data();
    line_ = Line{of.source, of.id, of.second, coming_};
    on_way_.pop();
  }
  void take_request(const Asked& asked) {
    if (beyond(asked)) return;
    TreeRequest request;
    OnWay on_way{asked.source, asked.id, false};
    if (asked.source == Source::Stacks) {
      const LaneStacks::Request& stack = *asked.stack;
      const uint32_t slot = asked.lane << slot_bits_ | stack.slot;
      request.write = request.second = stack.write;
      request.address = places_.stacks * kLine + (slot << kBlockBits | stack.block) * (kLine / 2);
      if (!stack.write) request.address &= ~(kLine - 1);
      on_way.id = asked.lane;
      on_way.second = stack.block % 2 != 0;
      for (uint32_t i = 0; stack.write && i < LaneStacks::kBlock; ++i) {
        Beat& beat = request.data[i / 2];
        beat[i % 2 * kEntryWords] = stack.entries[i].reference;
        beat[i % 2 * kEntryWords + 1] = stack.entries[i].key;
      }
    } else {
      request.address = ((asked.source == Source::Nodes ? 0 : places_.triangles) + asked.line) * kLine;
    }
    ++(request.write ? blocks_written_ : lines_read_);
    if (!request.write) on_way_.push(on_way);
    request_ = request;
  }

  uint32_t slot_bits_;
  Places places_;
  RoundRobin turn_, stack_turn_;
  uint32_t lane_ = 0;
  std::optional<TreeRequest> request_;
  TreeFault fault_;
  RamQueue<OnWay> on_way_;
  TreeLine coming_{};
  uint32_t beat_ = 0;  // that comes next
  std::optional<Line> line_;
  uint64_t lines_read_ = 0, blocks_written_ = 0;
};

}  // namespace raypool
