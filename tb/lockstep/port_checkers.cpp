// Checkers of what passes the unit's ports: memory writes, imports, exports, frame contributions, stability.
#include <fmt/format.h>

#include "lockstep/checkers.hpp"
#include "lockstep/text.hpp"

namespace raypool::lockstep {
namespace {

constexpr const char* kMemoryModules = "rtl/data_cache.v, rtl/request_queue.v, rtl/mem_alu.v";
constexpr const char* kRayModules = "rtl/ray_alu.v, rtl/ray_memory.v";

std::string quadword_line(const char* who, uint32_t address, uint32_t mask, const Beat& data) {
  std::string text = fmt::format("  {:<5} {:08x}, word mask {}:", who, address, mask_text(mask, kBeatWords));
  for (uint32_t i = 0; i < kBeatWords; ++i) text += mask >> i & 1 ? ' ' + word_text(data[i]) : " -";
  return text + '\n';
}

std::string origin_line(const Origin& origin) {
  return fmt::format("  the model made it at warp {}, PC {}, lane {}\n", origin.warp, origin.pc, origin.lane);
}

std::string word_line(const std::string& name, uint32_t rtl, uint32_t model) {
  return fmt::format("  {:<12} RTL {:<24} model {:<24}{}", name, word_text(rtl), word_text(model),
                     rtl == model ? "\n" : "  <-- differs\n");
}

}  // namespace

void MemoryPortChecker::traced(const StoreEvent& event) {
  traced_.push_back(event);
  match();
}

void MemoryPortChecker::written(const MemoryRequest& request) {
  written_.push_back(request);
  match();
}

void MemoryPortChecker::match() {
  while (!traced_.empty() && !written_.empty()) {
    const StoreEvent& store = traced_.front();
    const MemoryRequest& write = written_.front();
    bool same = store.address == write.address && store.mask == write.mask;
    for (uint32_t i = 0; i < kBeatWords; ++i) same = same && (!(store.mask >> i & 1) || store.data[i] == write.data[i]);
    if (!same) {
      throw Mismatch{"a write on the memory port is not the store that is due",
                     quadword_line("port", write.address, write.mask, write.data) +
                         quadword_line("store", store.address, store.mask, store.data) +
                         fmt::format("  the store is of warp {}\n", store.warp),
                     kMemoryModules, Context::Unit};
    }
    ++counts_->memory_writes;
    traced_.pop_front();
    written_.pop_front();
  }
}

void MemoryPortChecker::check_idle() const {
  if (!traced_.empty()) {
    const StoreEvent& store = traced_.front();
    throw Mismatch{fmt::format("the unit is idle and {} stores have not left through the memory port", traced_.size()),
                   quadword_line("first", store.address, store.mask, store.data), kMemoryModules, Context::Unit};
  }
  if (!written_.empty()) {
    const MemoryRequest& write = written_.front();
    throw Mismatch{fmt::format("the memory port carried {} writes that no instruction made", written_.size()),
                   quadword_line("first", write.address, write.mask, write.data), kMemoryModules, Context::Unit};
  }
}

void ImportChecker::requested(ImportKind kind) {
  if (jobs_.empty()) throw Mismatch{"the RTL requests a package that no launch has asked for", "", kRayModules, Context::Unit};
  Job& job = jobs_.front();
  if (kind != job.kind) {
    throw Mismatch{
        "the RTL requests a package of another kind than the launch names",
        fmt::format("  RTL kind {}, launch kind {} (1 normal, 2 shadow)\n", static_cast<int>(kind), static_cast<int>(job.kind)),
        kRayModules, Context::Unit};
  }
  if (--job.left == 0) jobs_.pop_front();
}

void ImportChecker::check_idle() const {
  if (jobs_.empty()) return;
  throw Mismatch{fmt::format("the unit is idle and has not requested {} packages of a launch", jobs_.front().left), "",
                 kRayModules, Context::Unit};
}

void ExportChecker::expect(const Ray& ray, const Origin& origin) {
  expected_.push_back({ray, origin});
  match();
}

void ExportChecker::beat(const Beat& data, bool last) {
  for (uint32_t i = 0; i < kBeatWords; ++i) arriving_[beats_ * kBeatWords + i] = data[i];
  ++beats_;
  if (last != (beats_ == kRayBeats)) {
    throw Mismatch{fmt::format("export_last is {} in beat {} of a ray", last, beats_ - 1), "", kRayModules, Context::Unit};
  }
  if (beats_ < kRayBeats) return;
  beats_ = 0;
  seen_.push_back(arriving_);
  match();
}

void ExportChecker::match() {
  while (!expected_.empty() && !seen_.empty()) {
    const Expected& expected = expected_.front();
    if (expected.ray != seen_.front()) {
      std::string details = origin_line(expected.origin);
      for (uint32_t i = 0; i < kRayWords; ++i) details += word_line(fmt::format("word {}", i), seen_.front()[i], expected.ray[i]);
      throw Mismatch{"an exported ray differs", details, kRayModules, Context::Unit};
    }
    ++counts_->exports;
    expected_.pop_front();
    seen_.pop_front();
  }
}

void ExportChecker::check_idle() const {
  if (expected_.empty() && seen_.empty() && beats_ == 0) return;
  throw Mismatch{
      "the unit is idle and RTL and model have exported different numbers of rays",
      fmt::format("  {} rays more of the model, {} rays and {} beats more of the RTL\n", expected_.size(), seen_.size(), beats_) +
          (expected_.empty() ? "" : origin_line(expected_.front().origin)),
      kRayModules, Context::Unit};
}

void FrameChecker::expect(const FrameContribution& contribution, const Origin& origin) {
  expected_.push_back({contribution, origin});
  match();
}

void FrameChecker::seen(const FrameContribution& contribution) {
  seen_.push_back(contribution);
  match();
}

void FrameChecker::match() {
  while (!expected_.empty() && !seen_.empty()) {
    const FrameContribution& model = expected_.front().contribution;
    const FrameContribution& rtl = seen_.front();
    if (model.pixel != rtl.pixel || model.rgb != rtl.rgb) {
      throw Mismatch{"a frame contribution differs",
                     origin_line(expected_.front().origin) + word_line("pixel", rtl.pixel, model.pixel) +
                         word_line("red", rtl.rgb[0], model.rgb[0]) + word_line("green", rtl.rgb[1], model.rgb[1]) +
                         word_line("blue", rtl.rgb[2], model.rgb[2]),
                     kRayModules, Context::Unit};
    }
    ++counts_->frame_contributions;
    expected_.pop_front();
    seen_.pop_front();
  }
}

void FrameChecker::check_idle() const {
  if (expected_.empty() && seen_.empty()) return;
  throw Mismatch{"the unit is idle and RTL and model have made different numbers of frame contributions",
                 fmt::format("  {} more of the model, {} more of the RTL\n", expected_.size(), seen_.size()), kRayModules,
                 Context::Unit};
}

void StabilityChecker::remember(const UnitOutputs& outputs, const UnitInputs& inputs) {
  memory_ = outputs.memory_request_valid && !inputs.memory_request_ready;
  import_ = outputs.import_request_valid && !inputs.import_request_ready;
  export_ = outputs.export_valid && !inputs.export_ready;
  frame_ = outputs.frame_valid && !inputs.frame_ready;
  if (memory_ || import_ || export_ || frame_) before_ = outputs;
}

void StabilityChecker::check(const UnitOutputs& now) const {
  const auto unstable = [](const char* port, const char* modules) {
    return Mismatch{fmt::format("the {} port changed while it waited for ready", port), "", modules, Context::Unit};
  };
  if (memory_) {
    const MemoryRequest &a = before_.memory_request, &b = now.memory_request;
    bool same = now.memory_request_valid && a.write == b.write && a.address == b.address;
    if (a.write) {
      same = same && a.mask == b.mask && a.data == b.data;
    } else {
      same = same && a.id == b.id;
    }
    if (!same) throw unstable("memory", kMemoryModules);
  }
  if (import_ && !(now.import_request_valid && now.import_request_kind == before_.import_request_kind)) {
    throw unstable("import", kRayModules);
  }
  if (export_ && !(now.export_valid && now.export_data == before_.export_data && now.export_last == before_.export_last)) {
    throw unstable("export", kRayModules);
  }
  if (frame_ && !(now.frame_valid && now.frame.pixel == before_.frame.pixel && now.frame.rgb == before_.frame.rgb)) {
    throw unstable("frame", kRayModules);
  }
}

}  // namespace raypool::lockstep
