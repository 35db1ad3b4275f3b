// What is live at the traces of a shader, in SPIR-V's own blocks.
#include "shader/waits.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <unordered_map>

namespace raypool::shader {

std::vector<uint32_t> successors(const Block& block) {
  const std::vector<uint32_t>& operands = block.end.operands;
  switch (block.end.op) {
    case spv::Op::OpBranch:
      return {operands.at(0)};
    case spv::Op::OpBranchConditional:
      return {operands.at(1), operands.at(2)};
    case spv::Op::OpSwitch: {
      std::vector<uint32_t> labels;
      for (size_t i = 1; i < operands.size(); i += 2) labels.push_back(operands[i]);
      return labels;
    }
    default:
      return {};
  }
}

namespace {

bool is_access(spv::Op op) { return op == spv::Op::OpAccessChain || op == spv::Op::OpInBoundsAccessChain; }

/// How many of a line's operands, from `first` on, are ids; the others are literals.
struct Ids {
  size_t first = 0, end = SIZE_MAX;
};
Ids ids_of(const Line& line) {
  switch (line.op) {
    case spv::Op::OpCompositeExtract:
    case spv::Op::OpLoad:
      return {0, 1};
    case spv::Op::OpCompositeInsert:
    case spv::Op::OpVectorShuffle:
    case spv::Op::OpStore:
      return {0, 2};
    case spv::Op::OpExtInst:
      return {2, SIZE_MAX};
    case spv::Op::OpArrayLength:
      return {0, 1};
    default:
      return {};
  }
}

class Liveness {
 public:
  explicit Liveness(const Module& module) : module_(module) {
    for (const Block& block : module.blocks()) {
      for (const auto* lines : {&block.phis, &block.lines})
        for (const Line& line : *lines)
          if (line.id != 0) made_[line.id] = &line;
    }
    for (const auto& [id, variable] : module.variables())
      if (has_content(variable.storage)) variables_.insert(id);
    for (const auto& [id, line] : module.locals()) variables_.insert(id);
    find_entries();
  }

  /// Calls seen(line, what is live behind it) for each trace, from the last to the first of each block.
  template <typename Seen>
  void at_traces(bool returns_payload, const Seen& seen) {
    returns_payload_ = returns_payload;
    find_entries();
    for (const Block& block : module_.blocks()) {
      std::set<uint32_t> live = behind(block);
      for (size_t i = block.lines.size(); i-- > 0;) {
        const Line& line = block.lines[i];
        if (line.op == spv::Op::OpTraceRayKHR) seen(line, live);
        step(line, live);
      }
    }
  }

  bool is_variable(uint32_t id) const { return variables_.count(id) != 0; }
  const Line* made(uint32_t id) const {
    const auto found = made_.find(id);
    return found == made_.end() ? nullptr : found->second;
  }
  /// The variable that a pointer leads to; 0: none that has content of its own.
  uint32_t root(uint32_t pointer) const {
    while (const Line* line = made(pointer)) {
      if (!is_access(line->op)) return 0;
      pointer = line->operands.at(0);
    }
    return is_variable(pointer) ? pointer : 0;
  }

 private:
  static bool has_content(spv::StorageClass storage) {
    switch (storage) {
      case spv::StorageClass::Private:
      case spv::StorageClass::Function:
      case spv::StorageClass::Input:
      case spv::StorageClass::HitAttributeKHR:
      case spv::StorageClass::RayPayloadKHR:
      case spv::StorageClass::IncomingRayPayloadKHR:
      case spv::StorageClass::CallableDataKHR:
      case spv::StorageClass::IncomingCallableDataKHR:
        return true;
      default:
        return false;
    }
  }

  void find_entries() {
    entries_.clear();
    for (bool changed = true; changed;) {
      changed = false;
      for (auto block = module_.blocks().rbegin(); block != module_.blocks().rend(); ++block) {
        std::set<uint32_t> live = behind(*block);
        for (size_t i = block->lines.size(); i-- > 0;) step(block->lines[i], live);
        for (const Line& phi : block->phis) live.erase(phi.id);
        std::set<uint32_t>& entry = entries_[block->label];
        if (live.size() == entry.size()) continue;
        entry = std::move(live);
        changed = true;
      }
    }
  }

  /// Behind the block's lines.
  std::set<uint32_t> behind(const Block& block) {
    std::set<uint32_t> live;
    for (const uint32_t next : successors(block)) {
      const auto entry = entries_.find(next);
      if (entry != entries_.end()) live.insert(entry->second.begin(), entry->second.end());
      for (const Line& phi : module_.block(next).phis)
        for (size_t i = 0; i + 1 < phi.operands.size(); i += 2)
          if (phi.operands[i + 1] == block.label) use(phi.operands[i], live);
    }
    if (block.end.op == spv::Op::OpBranchConditional || block.end.op == spv::Op::OpSwitch)
      use(block.end.operands.at(0), live);
    const bool ends = successors(block).empty() && block.end.op != spv::Op::OpUnreachable;
    if (ends && returns_payload_) {
      for (const auto& [id, variable] : module_.variables())
        if (variable.storage == spv::StorageClass::IncomingRayPayloadKHR) live.insert(id);
    }
    return live;
  }

  void use(uint32_t id, std::set<uint32_t>& live) const {
    const Line* line = made(id);
    if (line == nullptr) return;
    if (!is_access(line->op) && line->op != spv::Op::OpImage) {
      live.insert(id);
      return;
    }
    // What it is made of is needed, not itself.
    for (const uint32_t part : line->operands) use(part, live);
  }

  void write(uint32_t pointer, std::set<uint32_t>& live) const {
    if (is_variable(pointer))
      live.erase(pointer);
    else
      use(pointer, live);
  }

  void step(const Line& line, std::set<uint32_t>& live) const {
    live.erase(line.id);
    const Ids ids = ids_of(line);
    const size_t end = std::min(ids.end, line.operands.size());
    const auto use_all = [&](size_t first, size_t last) {
      for (size_t i = first; i < last; ++i) use(line.operands[i], live);
    };
    switch (line.op) {
      case spv::Op::OpAccessChain:
      case spv::Op::OpInBoundsAccessChain:
      case spv::Op::OpImage:
        return;  // where it is used
      case spv::Op::OpStore:
        write(line.operands.at(0), live);
        use(line.operands.at(1), live);
        return;
      case spv::Op::OpLoad:
        use(line.operands.at(0), live);
        if (const uint32_t variable = root(line.operands.at(0))) live.insert(variable);
        return;
      case spv::Op::OpTraceRayKHR:
        use_all(0, 10);
        if (const uint32_t payload = payload_of(line); is_variable(payload)) live.insert(payload);
        return;
      case spv::Op::OpExecuteCallableKHR:
        use(line.operands.at(0), live);
        live.insert(line.operands.at(1));
        return;
      case spv::Op::OpExtInst: {
        const uint32_t last = line.operands.back();
        const uint32_t type = module_.type_of(last);
        const bool writes = (type != 0 && module_.type(type).kind == TypeKind::Pointer) || is_variable(last);
        if (writes) write(last, live);
        use_all(ids.first, writes ? end - 1 : end);
        return;
      }
      default:
        use_all(std::min(ids.first, end), end);
    }
  }

  const Module& module_;
  bool returns_payload_ = false;
  std::unordered_map<uint32_t, const Line*> made_;
  std::set<uint32_t> variables_;
  std::map<uint32_t, std::set<uint32_t>> entries_;  // [label] what is live before its lines
};

/// Blocks that lanes may come to behind this one.
std::set<uint32_t> reachable(const Module& module, uint32_t from) {
  std::set<uint32_t> seen;
  std::vector<uint32_t> found = successors(module.block(from));
  while (!found.empty()) {
    const uint32_t label = found.back();
    found.pop_back();
    if (!seen.insert(label).second) continue;
    for (const uint32_t next : successors(module.block(label))) found.push_back(next);
  }
  return seen;
}

/// Of lines that depend on nothing but the thread's pixel and what is known when shaders are compiled. Beside moves and
/// conversions, these are integers and conditions made of uniform blocks, which are known then in most cases.
class Steady {
 public:
  Steady(const Module& module, const Liveness& liveness) : module_(module), liveness_(liveness) {}

  bool is(uint32_t id) {
    const Line* line = liveness_.made(id);
    if (line == nullptr) return module_.type_of(id) != 0;  // a constant
    const auto known = known_.find(id);
    if (known != known_.end()) return known->second;
    known_[id] = false;
    return known_[id] = is_line(*line);
  }

  void add(uint32_t id, std::vector<const Line*>& to) const {
    const Line* line = liveness_.made(id);
    if (line == nullptr || std::find(to.begin(), to.end(), line) != to.end()) return;
    const Ids ids = ids_of(*line);
    for (size_t i = ids.first; i < std::min(ids.end, line->operands.size()); ++i) add(line->operands[i], to);
    to.push_back(line);
  }

  /// Of a variable that is the same in all kernels of a path.
  bool is_steady_pointer(uint32_t pointer) const {
    const auto variable = module_.variables().find(pointer);
    if (variable == module_.variables().end() || variable->second.storage != spv::StorageClass::Input) return false;
    const auto number = module_.decorations(pointer).built_in;
    return number && (*number == static_cast<uint32_t>(spv::BuiltIn::LaunchIdKHR) ||
                      *number == static_cast<uint32_t>(spv::BuiltIn::LaunchSizeKHR));
  }

 private:
  /// A part of a uniform block, the push constants or the shader record, at constant indices.
  bool is_of_block(uint32_t pointer) const {
    while (const Line* line = liveness_.made(pointer)) {
      if (!is_access(line->op)) return false;
      for (size_t i = 1; i < line->operands.size(); ++i)
        if (liveness_.made(line->operands[i]) != nullptr) return false;
      pointer = line->operands.at(0);
    }
    const auto variable = module_.variables().find(pointer);
    if (variable == module_.variables().end()) return false;
    const spv::StorageClass storage = variable->second.storage;
    return storage == spv::StorageClass::Uniform || storage == spv::StorageClass::PushConstant ||
           storage == spv::StorageClass::ShaderRecordBufferKHR;
  }

  /// Made of constants and uniform blocks alone.
  bool is_fixed(uint32_t id) {
    const Line* line = liveness_.made(id);
    if (line == nullptr) return module_.type_of(id) != 0;
    const auto known = fixed_.find(id);
    if (known != fixed_.end()) return known->second;
    return fixed_[id] = is_fixed_line(*line);
  }
  bool is_fixed_line(const Line& line) {
    switch (line.op) {
      case spv::Op::OpLoad:
        return is_of_block(line.operands.at(0));
      case spv::Op::OpCompositeExtract:
      case spv::Op::OpBitcast:
      case spv::Op::OpIAdd:
      case spv::Op::OpISub:
      case spv::Op::OpIMul:
      case spv::Op::OpBitwiseAnd:
      case spv::Op::OpBitwiseOr:
      case spv::Op::OpSelect:
      case spv::Op::OpLogicalAnd:
      case spv::Op::OpLogicalOr:
      case spv::Op::OpLogicalNot:
      case spv::Op::OpIEqual:
      case spv::Op::OpINotEqual:
      case spv::Op::OpSLessThan:
      case spv::Op::OpSLessThanEqual:
      case spv::Op::OpSGreaterThan:
      case spv::Op::OpSGreaterThanEqual:
      case spv::Op::OpULessThan:
      case spv::Op::OpULessThanEqual:
      case spv::Op::OpUGreaterThan:
      case spv::Op::OpUGreaterThanEqual:
        break;
      default:
        return false;
    }
    const Ids ids = ids_of(line);
    for (size_t i = ids.first; i < std::min(ids.end, line.operands.size()); ++i)
      if (!is_fixed(line.operands[i])) return false;
    return true;
  }

  bool is_line(const Line& line) {
    if (is_fixed(line.id)) return true;
    switch (line.op) {
      case spv::Op::OpLoad:
        return is_steady_pointer(line.operands.at(0));
      case spv::Op::OpCompositeExtract:
      case spv::Op::OpCompositeConstruct:
      case spv::Op::OpVectorShuffle:
      case spv::Op::OpBitcast:
      case spv::Op::OpConvertUToF:
      case spv::Op::OpConvertSToF:
        break;
      default:
        return false;
    }
    const Ids ids = ids_of(line);
    for (size_t i = ids.first; i < std::min(ids.end, line.operands.size()); ++i)
      if (!is(line.operands[i])) return false;
    return true;
  }

  const Module& module_;
  const Liveness& liveness_;
  std::map<uint32_t, bool> known_, fixed_;
};

/// Whether a shader that ends with its traces could not do as much.
bool must_wait(const Module& module, Liveness& liveness, const std::vector<TraceSite>& sites) {
  const bool casts_one = module.stage() == spv::ExecutionModel::RayGenerationKHR;
  bool needed = module.stage() == spv::ExecutionModel::MissKHR;  // that traces
  liveness.at_traces(
      false, [&](const Line& line, const std::set<uint32_t>& live) { needed |= live.count(payload_of(line)) != 0; });
  // A thread may send one ray of each kind.
  for (const TraceSite& one : sites) {
    const std::set<uint32_t> next = reachable(module, one.block);
    needed |= casts_one && is_shadow(module, *one.line);
    const uint32_t flags = module.constant(one.line->operands.at(1)).value_or(0);
    needed |= (flags & (ray_flag::kCullsBack | ray_flag::kCullsFront)) != 0;
    needed |= (flags & kShadowRay) != 0 && (flags & kShadowRay) != kShadowRay;
    for (const TraceSite& other : sites) {
      const bool follows = next.count(other.block) != 0 || (one.block == other.block && one.number < other.number);
      needed |= follows && (casts_one || is_shadow(module, *one.line) == is_shadow(module, *other.line));
    }
  }
  return needed;
}

}  // namespace

bool writes_memory(const Module& module) {
  const auto is_store = [&](const Line& line) {
    if (line.op != spv::Op::OpStore) return false;
    const spv::StorageClass storage = module.type(module.type_of(line.operands.at(0))).storage;
    return storage == spv::StorageClass::StorageBuffer || storage == spv::StorageClass::PhysicalStorageBuffer;
  };
  return std::any_of(module.blocks().begin(), module.blocks().end(),
                     [&](const Block& block) { return std::any_of(block.lines.begin(), block.lines.end(), is_store); });
}

bool is_shadow(const Module& module, const Line& trace) {
  return (module.constant(trace.operands.at(1)).value_or(0) & kShadowRay) == kShadowRay;
}

const TraceSite* Waits::site(const Line& line) const {
  for (const TraceSite& one : sites)
    if (one.line == &line) return &one;
  return nullptr;
}

bool Waits::is_steady(const Line& line) const { return std::find(steady.begin(), steady.end(), &line) != steady.end(); }

uint32_t payload_type(const Module& module, const Line& trace) {
  const auto variable = module.variables().find(payload_of(trace));
  if (variable == module.variables().end())
    module.fail(trace.where, "the payload of a ray must be a variable of the shader");
  return module.type(variable->second.type).element;
}

uint32_t held_words(const Module& module, uint32_t id) {
  const auto variable = module.variables().find(id);
  if (variable != module.variables().end()) return module.scalars(module.type(variable->second.type).element);
  const auto local = module.locals().find(id);
  if (local != module.locals().end()) return module.scalars(module.type(local->second.type).element);
  return std::max(1u, module.scalars(module.type_of(id)));  // one of a pointer or an image
}

uint32_t most_held_words(const Module& module, const Waits& waits) {
  uint32_t most = 0;
  for (const TraceSite& site : waits.sites) {
    uint32_t words = 0;
    for (const uint32_t id : site.held) words += held_words(module, id);
    most = std::max(most, words);
  }
  return most;
}

Waits find_waits(const Module& module, uint32_t first) {
  Waits waits;
  for (const Block& block : module.blocks()) {
    const bool again = reachable(module, block.label).count(block.label) != 0;
    for (const Line& line : block.lines)
      if (line.op == spv::Op::OpTraceRayKHR) waits.sites.push_back({first++, &line, block.label, again, {}});
  }
  if (waits.sites.empty()) return waits;
  Liveness liveness(module);
  waits.needed = must_wait(module, liveness, waits.sites);
  Steady steady(module, liveness);
  liveness.at_traces(true, [&](const Line& line, const std::set<uint32_t>& live) {
    const auto site =
        std::find_if(waits.sites.begin(), waits.sites.end(), [&](const TraceSite& one) { return one.line == &line; });
    for (const uint32_t id : live) {
      if (id == payload_of(line) || steady.is_steady_pointer(id)) continue;
      if (!liveness.is_variable(id) && steady.is(id)) {
        steady.add(id, waits.steady);
        continue;
      }
      site->held.push_back(id);
      (liveness.is_variable(id) ? waits.variables : waits.values).insert(id);
    }
  });
  return waits;
}

}  // namespace raypool::shader
