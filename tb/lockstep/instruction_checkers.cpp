// Checkers of what an instruction does inside the unit: result, stores, ray memory.
#include <fmt/format.h>

#include <algorithm>

#include "lockstep/checkers.hpp"
#include "lockstep/text.hpp"

namespace raypool::lockstep {

void RetirementChecker::check_place(const RetireEvent& rtl, const InstructionContext& context) const {
  const auto both = [&] {
    return fmt::format("  RTL   PC {:>5}: {}\n  model PC {:>5}: {}\n", rtl.pc, instruction_text(rtl.instruction), context.pc,
                       context.instruction ? instruction_text(context.instruction->encoding) : "outside the program");
  };
  if (rtl.pc != context.pc) {
    throw Mismatch{fmt::format("warp {} retired another PC than the model's", rtl.warp), both(), "rtl/pc_stack.v, rtl/brh_alu.v",
                   Context::Warp};
  }
  if (context.instruction != nullptr && rtl.instruction != context.instruction->encoding) {
    throw Mismatch{
        fmt::format("warp {} executed another instruction than lies in memory at PC {}", rtl.warp, rtl.pc),
        both() + fmt::format("  encoding: RTL {:016x}, memory {:016x}\n", rtl.instruction, context.instruction->encoding),
        "rtl/instruction_cache.v, rtl/instruction_buffer.v", Context::Warp};
  }
  if (context.instruction != nullptr && rtl.mask != context.mask) {
    throw Mismatch{
        "the thread mask differs",
        fmt::format("  RTL   {}\n  model {}  (lane 0 rightmost)\n", mask_text(rtl.mask, lanes_), mask_text(context.mask, lanes_)),
        "rtl/predicate_file.v, rtl/warp.v", Context::Operands};
  }
}

void RetirementChecker::check_result(const RetireEvent& rtl, const Step& model, const InstructionContext& context) {
  ++counts_->instructions;
  if (model.data != nullptr) {
    for (uint32_t mask = model.mask; mask != 0; mask &= mask - 1) {
      const int lane = __builtin_ctz(mask);
      if (rtl.data[static_cast<size_t>(lane)] == model.data[lane]) continue;
      throw Mismatch{"the register result differs", lane_table(context, lanes_, rtl.data.data(), model.data),
                     module_of(context.instruction), Context::Instruction};
    }
    counts_->thread_results += static_cast<uint64_t>(__builtin_popcount(model.mask));
  } else if (model.instruction->writes_predicate) {
    if (rtl.predicate != model.predicate) {
      throw Mismatch{"the predicate result differs",
                     fmt::format("  RTL   {}\n  model {}  (lane 0 rightmost)\n", mask_text(rtl.predicate, lanes_),
                                 mask_text(model.predicate, lanes_)),
                     module_of(context.instruction), Context::Operands};
    }
    counts_->thread_results += static_cast<uint64_t>(lanes_);
  }
}

namespace {

// The highest lane, which comes last, wins a word that is stored twice. Sorted by address.
void merge(std::vector<Step::LaneStore>& stores) {
  const auto before = [](const auto& a, const auto& b) { return a.address < b.address; };
  if (!std::is_sorted(stores.begin(), stores.end(), before)) std::stable_sort(stores.begin(), stores.end(), before);
  size_t kept = 0;
  for (size_t i = 0; i < stores.size(); ++i) {
    if (i + 1 < stores.size() && stores[i].address == stores[i + 1].address) continue;
    stores[kept++] = stores[i];
  }
  stores.resize(kept);
}

std::string store_lines(const char* who, const std::vector<Step::LaneStore>& stores) {
  std::string text = fmt::format("  {}:{}\n", who, stores.empty() ? " nothing" : "");
  for (const auto& store : stores) text += fmt::format("    word {:08x} = {}\n", store.address, word_text(store.value));
  return text;
}

}  // namespace

void StoreChecker::traced(const StoreEvent& event) {
  for (uint32_t i = 0; i < kBeatWords; ++i) {
    if (event.mask >> i & 1) traced_[event.warp].push_back({0, event.address + 4 * i, event.data[i]});
  }
}

void StoreChecker::check(const Step& model) {
  std::vector<Step::LaneStore>& traced = traced_[model.warp];
  if (model.store_count == 0 && traced.empty()) return;
  expected_.assign(model.stores.begin(), model.stores.begin() + static_cast<std::ptrdiff_t>(model.store_count));
  merge(traced);
  merge(expected_);
  const bool same = std::equal(traced.begin(), traced.end(), expected_.begin(), expected_.end(),
                               [](const auto& a, const auto& b) { return a.address == b.address && a.value == b.value; });
  if (!same) {
    throw Mismatch{"the words stored differ", store_lines("RTL", traced) + store_lines("model", expected_),
                   "rtl/mem_alu.v, rtl/data_cache.v", Context::Operands};
  }
  counts_->stores += expected_.size();
  traced.clear();
}

void StoreChecker::reset() {
  for (auto& stores : traced_) stores.clear();
}

RayWriteChecker::RayWriteChecker(int warps, int lanes, LockstepCounts& counts)
    : lanes_(lanes), written_(static_cast<size_t>(warps)), counts_(&counts) {}

void RayWriteChecker::traced(const RayWriteEvent& event) {
  if (event.mask == 0) return;
  Written& written = written_[event.warp];
  if (written.mask != 0 && written.word != event.word) {
    throw Mismatch{
        fmt::format("warp {} wrote words {} and {} of ray memory in one instruction", event.warp, written.word, event.word), "",
        "rtl/ray_alu.v", Context::Unit};
  }
  written.word = event.word;
  written.mask |= event.mask;
  for (size_t lane = 0; lane < event.data.size(); ++lane) {
    if (event.mask >> lane & 1) written.data[lane] = event.data[lane];
  }
}

void RayWriteChecker::check(const Step& model, const InstructionContext& context) {
  Written& written = written_[model.warp];
  const uint32_t mask = model.ray_words != nullptr ? model.mask : 0;
  if (mask == 0 && written.mask == 0) return;
  bool same = written.mask == mask && written.word == model.instruction->x;
  for (uint32_t left = mask; same && left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    same = written.data[static_cast<size_t>(lane)] == model.ray_words[lane];
  }
  if (!same) {
    std::string details =
        fmt::format("  RTL wrote word {} of lanes {}, the model word {} of lanes {} (lane 0 rightmost)\n", written.word,
                    mask_text(written.mask, lanes_), model.instruction->x, mask_text(mask, lanes_));
    if (model.ray_words != nullptr) details += lane_table(context, lanes_, written.data.data(), model.ray_words);
    throw Mismatch{"the words written to ray memory differ", details, "rtl/ray_alu.v",
                   model.ray_words == nullptr ? Context::Operands : Context::Instruction};
  }
  counts_->ray_words += static_cast<uint64_t>(__builtin_popcount(mask));
  written.mask = 0;
}

void RayWriteChecker::reset() {
  for (Written& written : written_) written.mask = 0;
}

}  // namespace raypool::lockstep
