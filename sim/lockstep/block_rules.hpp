// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// Rules of blocks inside a chip: of a block's own inputs in the RTL a rule knows what its outputs must be. So whatever
// is wrong around it, a block with outputs that break its rule is wrong itself, and one that keeps it is not.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "config/configuration.hpp"
#include "lockstep/findings.hpp"
#include "lockstep/rtl_files.hpp"
#include "lockstep/wire.hpp"
#include "machine/chip/chip_device.hpp"

namespace raypool::lockstep {

/// An instance, by its scope from the chip on, of the module `file` inside the module `parent`.
struct Block {
  const ChipDevice* chip;
  std::string scope, file, parent;

  /// An instance inside it.
  Block inner(const std::string& instance, const std::string& module) const {
    return {chip, scope + "." + instance, module, file};
  }
};

class BlockRule {
 public:
  explicit BlockRule(Block block) : block_(std::move(block)), files_(rtl_files({block_.file, block_.parent})) {}
  BlockRule(const BlockRule&) = delete;
  BlockRule& operator=(const BlockRule&) = delete;
  virtual ~BlockRule() = default;

  /// The RTL has all that the rule looks at.
  bool present() const { return present_; }
  /// The block has been reset.
  virtual void reset() {}
  /// Cycles have passed that were not looked at, and in which the block had nothing to do.
  virtual void forget() {}
  /// What the block shows in this cycle, of its inputs in those before.
  virtual void compare(Findings& findings) = 0;
  /// The end of the cycle: all wires have settled.
  virtual void take() = 0;

 protected:
  Wire wire(const std::string& name) { return wire_of(block_, name); }
  /// Of an instance inside it.
  Wire wire_of(const Block& block, const std::string& name) {
    Wire found(*block.chip, block.scope, name);
    present_ = present_ && found.present();
    return found;
  }
  /// True if they are the same.
  bool expect(Findings& findings, uint64_t rtl, uint64_t rule, const char* what) const {
    return expect(findings, rtl, rule, what, files_);
  }
  bool expect(Findings& findings, uint64_t rtl, uint64_t rule, const char* what, const std::string& files) const {
    if (rtl == rule) return true;
    findings.add(files, fmt::format("{}, {}: {:x} in the RTL, {:x} by its rule (bits, hexadecimal)", block_.scope, what,
                                    rtl, rule));
    return false;
  }
  const Block& block() const { return block_; }

 private:
  Block block_;
  std::string files_;
  bool present_ = true;
};

/// What was in each of the cycles before this one.
template <typename Value, size_t kMost = 64>
class History {
 public:
  void clear() { values_.clear(); }
  void push(Value value) {
    values_.push_back(std::move(value));
    if (values_.size() > kMost) values_.pop_front();
  }
  /// So many cycles ago, 1 or more; null: that cycle was not looked at.
  const Value* ago(size_t cycles) const {
    return cycles > values_.size() ? nullptr : &values_[values_.size() - cycles];
  }

 private:
  std::deque<Value> values_;
};

/// Of numbers between the traverser's blocks, which have the exponents of double, and fractions of several widths.
inline constexpr uint32_t kExponentBits = 11;
inline constexpr int kExponentBias = 1023;

/// A number as its sign, its exponent with its bias, and what is behind the leading one.
struct Number {
  bool negative;
  uint32_t exponent;
  uint64_t fraction;

  static Number of(uint64_t word, uint32_t fraction_bits) {
    return {(word >> (fraction_bits + kExponentBits) & 1) != 0,
            static_cast<uint32_t>(word >> fraction_bits & ((1u << kExponentBits) - 1)),
            word & ((uint64_t{1} << fraction_bits) - 1)};
  }
};

/// Of all blocks outside the traverser that have one, and of those inside it.
struct BlockRules {
  std::vector<std::unique_ptr<BlockRule>> chip, traverser;

  BlockRules(const Configuration& configuration, const ChipDevice& rtl);
};

void add_controller_rules(std::vector<std::unique_ptr<BlockRule>>& rules, const Configuration& configuration,
                          const ChipDevice& rtl);
void add_pool_rules(std::vector<std::unique_ptr<BlockRule>>& rules, const Configuration& configuration,
                    const ChipDevice& rtl);
void add_traverser_rules(std::vector<std::unique_ptr<BlockRule>>& rules, const Configuration& configuration,
                         const ChipDevice& rtl);
void add_triangle_rules(std::vector<std::unique_ptr<BlockRule>>& rules, const Block& group);
void add_finish_rules(std::vector<std::unique_ptr<BlockRule>>& rules, const Block& finish);
void add_queue_rule(std::vector<std::unique_ptr<BlockRule>>& rules, const Block& queue);
void add_quotient_rule(std::vector<std::unique_ptr<BlockRule>>& rules, const Block& digits);
void add_shorten_rule(std::vector<std::unique_ptr<BlockRule>>& rules, const Block& shorten);

template <typename Rule, typename... Arguments>
void add_rule(std::vector<std::unique_ptr<BlockRule>>& rules, Arguments&&... arguments) {
  auto rule = std::make_unique<Rule>(std::forward<Arguments>(arguments)...);
  if (rule->present()) rules.push_back(std::move(rule));
}

}  // namespace raypool::lockstep
