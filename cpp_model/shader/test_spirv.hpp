// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// For tests: runs a shader's SPIR-V directly, one thread at a time, block by block along its branches, as the SPIR-V
// specification defines each instruction. Nothing is shared with lowering but math.hpp, texture.hpp and the layouts of
// rays and intersections. Arithmetic is that of a machine without fused multiply-add, with IEEE subnormals.
#pragma once

#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "arith/arith.hpp"
#include "bits.hpp"
#include "kernel/native.hpp"
#include "machine/chip/ray_kernel.hpp"
#include "shader/math.hpp"
#include "shader/module.hpp"
#include "shader/resources.hpp"
#include "shader/texture.hpp"

namespace raypool::test {

/// What a thread does has no defined outcome: a branch on an undefined value, an index out of range.
struct UndefinedBehaviour : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A ray that leaves, and which of its bits are defined.
struct OracleRay {
  Ray words{};
  Ray defined{};
};
/// A contribution; `defined` as above.
struct OracleContribution {
  uint32_t pixel = 0;
  std::array<uint32_t, 3> rgb{};
  std::array<bool, 3> defined{};
};

class SpirvThread {
 public:
  struct Word {
    uint32_t bits = 0;
    bool known = false;
  };
  using Words = std::vector<Word>;
  /// A traceRayEXT that the shader waits for: the ray (its payload and flags are zero) and what it calls.
  struct Call {
    Ray ray{};
    uint32_t flags = 0, miss = 0, closest_hit = 0;
    float begin = 0;  ///< how far along the shader's ray this one begins
  };

  /// `arguments`, `input`: as a kernel gets them. `input` is what CastEye does not read.
  SpirvThread(const shader::Module& module, const shader::Resources& resources, RayKernel kernel,
              const std::array<uint32_t, kArguments>& arguments, Memory& memory)
      : module_(module), resources_(resources), kernel_(kernel), arguments_(arguments), memory_(memory) {
    native_.memory = &memory;
    native_.arguments = &arguments;
  }

  uint32_t thread = 0, block = 0;
  Intersection input{};
  std::vector<OracleRay> rays;
  std::vector<OracleContribution> frame;
  uint64_t most_blocks = 200000;
  Memory& memory() { return memory_; }
  RayKernel kernel() const { return kernel_; }
  /// Of a shader that waits for its rays: runs the shader that a ray comes to, which may change the payload.
  std::function<void(SpirvThread&, const Call&, Words&)> call;
  /// Of a shader that is called: the payload, before run() and behind it, and of the ray its flags and where it begins.
  std::optional<Words> payload;
  std::optional<uint32_t> ray_flags;
  float begin = 0;
  uint32_t level = 0;  ///< of a closest-hit shader: how many wait for it
  /// What executeCallableEXT counts; of a shader that it calls, its data before and behind run().
  std::vector<const shader::Module*> callables;
  std::optional<Words> callable_data;

  void run() {
    if (kernel_ == RayKernel::CastEye) {
      const uint32_t x = thread & arguments_[argument::kTileMask];
      const uint32_t y = thread >> arguments_[argument::kTileWidthLog2];
      pixel_ = (block & 0xffff) + x + (((block >> 16) + y) << 16);
      if ((pixel_ & 0xffff) >= resources_.width || pixel_ >> 16 >= resources_.height) return;
    } else {
      pixel_ = input[word::kPixel];
    }
    constants();
    variables();
    blocks();
    if (payload) give_payload();
    for (const auto& [id, variable] : module_.variables())
      if (variable.storage == spv::StorageClass::IncomingCallableDataKHR) callable_data = storage_.at(id);
  }

 private:
  using Op = spv::Op;
  using Native = kernel::NativeKernel<Subnormals::Ieee, SlowUnit::Exact>;
  using Float = Native::Float;
  using Int = Native::Int;

  enum class Place : uint8_t { Variable, Memory, Block, Texture, Picture, Tree };
  struct Pointer {
    Place place = Place::Variable;
    uint32_t type = 0;                                 // of what is there
    Words* variable = nullptr;                         // Variable
    const std::vector<shader::Word>* block = nullptr;  // Block
    uint32_t offset = 0;                               // words of a variable, else bytes
    uint32_t matrix_stride = 0, component_stride = 4;  // bytes
    bool row_major = false;
  };
  struct Value {
    Words words;
    std::optional<Pointer> pointer;
  };

  static Word known(uint32_t bits) { return {bits, true}; }
  static Word of(float value) { return known(as_bits(value)); }
  static arith::Mode mode() { return {}; }

  [[noreturn]] static void unsupported(const std::string& what, uint32_t number) {
    throw std::logic_error("the oracle does not know " + what + " " + std::to_string(number));
  }

  // ---- state before the first block

  void constants() {
    for (const shader::Line& line : module_.constants()) {
      Words words;
      if (const auto bits = module_.constant(line.id)) {
        words.push_back(known(*bits));
      } else if (module_.is_wide(line.type) && line.operands.size() == 2) {
        words = {known(line.operands[0]), known(line.operands[1])};
      } else if (line.op == Op::OpConstantComposite || line.op == Op::OpSpecConstantComposite) {
        for (const uint32_t part : line.operands) append(words, get(part));
      } else if (line.op == Op::OpConstantNull) {
        words.assign(module_.scalars(line.type), known(0));
      } else if (line.op == Op::OpUndef) {
        words.resize(module_.scalars(line.type));
      } else {
        unsupported("constant", static_cast<uint32_t>(line.op));
      }
      values_[line.id].words = std::move(words);
    }
  }

  // NOLINTNEXTLINE(readability-function-size): a list
  void variables() {
    for (const auto& [id, variable] : module_.variables()) {
      const shader::Type& pointer = module_.type(variable.type);
      const shader::Decorations& decorations = module_.decorations(id);
      const shader::Place binding = {decorations.set.value_or(0), decorations.binding.value_or(0)};
      Pointer to;
      to.type = pointer.element;
      switch (variable.storage) {
        case spv::StorageClass::Uniform:
        case spv::StorageClass::StorageBuffer:
          if (const auto found = resources_.blocks.find(binding); found != resources_.blocks.end()) {
            to.place = Place::Block;
            to.block = &found->second;
          } else {
            to.place = Place::Memory;
            to.offset = resources_.buffers.at(binding).address;
            ends_[id] = resources_.buffers.at(binding).bytes;
          }
          break;
        case spv::StorageClass::PushConstant:
          to.place = Place::Block;
          to.block = &resources_.push_constants;
          break;
        case spv::StorageClass::ShaderRecordBufferKHR:
          to.place = Place::Block;
          to.block = &resources_.records.at({shader::record_stage(module_.stage()), module_.number()});
          break;
        case spv::StorageClass::UniformConstant: {
          uint32_t element = pointer.element;
          const shader::TypeKind outer = module_.type(element).kind;
          if (outer == shader::TypeKind::Array || outer == shader::TypeKind::RuntimeArray)
            element = module_.type(element).element;
          const shader::TypeKind kind = module_.type(element).kind;
          to.place = kind == shader::TypeKind::SampledImage ? Place::Texture
                     : kind == shader::TypeKind::Image      ? Place::Picture
                                                            : Place::Tree;
          if (to.place == Place::Texture) to.offset = resources_.textures.at(binding).address;
          break;
        }
        default: {
          Words& words = storage_[id];
          if (variable.storage == spv::StorageClass::Input && decorations.built_in)
            words = built_in(*decorations.built_in, pointer.element);
          else if (variable.storage == spv::StorageClass::HitAttributeKHR)
            words = hit_attributes(module_.scalars(pointer.element));
          else if (variable.storage == spv::StorageClass::IncomingRayPayloadKHR)
            words = payload ? *payload : incoming_payload(pointer.element);
          else if (variable.storage == spv::StorageClass::IncomingCallableDataKHR && callable_data)
            words = *callable_data;
          else if (variable.initial != 0)
            words = get(variable.initial);
          words.resize(module_.scalars(pointer.element));
          to.variable = &words;
          break;
        }
      }
      values_[id].pointer = to;
    }
    for (const auto& [id, line] : module_.locals()) {
      Words& words = storage_[id];
      Pointer to;
      to.type = module_.type(line.type).element;
      if (line.operands.size() > 1) words = get(line.operands[1]);
      words.resize(module_.scalars(to.type));
      to.variable = &words;
      values_[id].pointer = to;
    }
  }

  Words input_words(int first, int count) const {
    Words words;
    for (int i = first; i < first + count; ++i) words.push_back(known(input.at(static_cast<size_t>(i))));
    return words;
  }

  /// From where the machine's ray begins.
  Words along_ray(float t) const {
    Words place = input_words(word::kOrigin, 3);
    const Words direction = input_words(word::kDirection, 3);
    for (size_t i = 0; t != 0.0f && i < 3; ++i) place[i] = add(mul(of(t), direction[i]), place[i]);
    return place;
  }

  Words built_in(uint32_t number, uint32_t type) const {
    const bool is_hit = kernel_ == RayKernel::CastSecondary || kernel_ == RayKernel::CastSecondaryDirect;
    switch (static_cast<spv::BuiltIn>(number)) {
      case spv::BuiltIn::LaunchIdKHR:
        return {known(pixel_ & 0xffff), known(pixel_ >> 16), known(0)};
      case spv::BuiltIn::LaunchSizeKHR:
        return {known(resources_.width), known(resources_.height), known(1)};
      case spv::BuiltIn::WorldRayOriginKHR:
      case spv::BuiltIn::ObjectRayOriginKHR:
        return along_ray(-begin);
      case spv::BuiltIn::WorldRayDirectionKHR:
      case spv::BuiltIn::ObjectRayDirectionKHR:
        return input_words(word::kDirection, 3);
      case spv::BuiltIn::RayTminKHR:
        return {of(begin)};
      case spv::BuiltIn::RayTmaxKHR:
        return {add(input_words(is_hit ? word::kDistance : word::kLimit, 1)[0], of(begin))};
      case spv::BuiltIn::PrimitiveId:
        return input_words(word::kTriangle, 1);
      case spv::BuiltIn::InstanceId:
      case spv::BuiltIn::InstanceCustomIndexKHR:
        return {known(0)};
      case spv::BuiltIn::RayGeometryIndexKHR: {
        const uint32_t first = resources_.geometries.value_or(input[word::kMaterial]);
        return {known((input[word::kMaterial] - first) / kMaterialBytes)};
      }
      case spv::BuiltIn::HitKindKHR: {
        // A ray meets the front where it runs against the normal.
        const Word along = dot(input_words(word::kDirection, 3), input_words(word::kNormal, 3));
        return {known(arith::greater(along.bits, 0, mode()) ? 0xffu : 0xfeu)};
      }
      case spv::BuiltIn::IncomingRayFlagsKHR:
        return {known(ray_flags.value_or(kernel_ == RayKernel::Shade ? 12u : 0u))};
      case spv::BuiltIn::ObjectToWorldKHR:
      case spv::BuiltIn::WorldToObjectKHR: {
        const uint32_t rows = module_.scalars(module_.type(type).element);
        Words words;
        for (uint32_t c = 0; c < module_.type(type).count; ++c)
          for (uint32_t r = 0; r < rows; ++r) words.push_back(of(r == c ? 1.0f : 0.0f));
        return words;
      }
      default:
        unsupported("built-in variable", number);
    }
  }

  Words hit_attributes(uint32_t size) const {
    Words words = input_words(word::kBarycentric, 6);
    words.push_back(known(input[word::kFlags] & kDepthMask));
    words.resize(size);
    return words;
  }

  /// The scalar types of a type, in order.
  std::vector<uint32_t> leaves(uint32_t type) const {
    const shader::Type& its = module_.type(type);
    std::vector<uint32_t> all;
    const auto add = [&](uint32_t part) {
      const std::vector<uint32_t> more = leaves(part);
      all.insert(all.end(), more.begin(), more.end());
    };
    if (its.kind == shader::TypeKind::Struct)
      for (const uint32_t member : its.members) add(member);
    else if (its.element != 0)
      for (uint32_t i = 0; i < its.count; ++i) add(its.element);
    else
      all.push_back(type);
    return all;
  }

  void give_payload() {
    for (const auto& [id, variable] : module_.variables()) {
      if (variable.storage != spv::StorageClass::IncomingRayPayloadKHR) continue;
      const Words& words = storage_.at(id);
      for (size_t i = 0; i < std::min(words.size(), payload->size()); ++i) (*payload)[i] = words[i];
    }
  }

  bool is_tag(uint32_t scalar) const {
    return module_.type(scalar).kind == shader::TypeKind::Int && module_.type(scalar).bits == 16;
  }

  Words incoming_payload(uint32_t type) const {
    Words words;
    int next = word::kColor;
    for (const uint32_t scalar : leaves(type)) {
      if (is_tag(scalar))
        words.push_back(known(input[word::kFlags] >> 8 & 0xffff));
      else
        words.push_back(known(input.at(static_cast<size_t>(next++))));
    }
    return words;
  }

  // ---- control

  void blocks() {
    const shader::Block* now = &module_.blocks().front();
    uint32_t before = 0;
    for (uint64_t count = 0; count < most_blocks; ++count) {
      std::vector<std::pair<uint32_t, Value>> arriving;
      for (const shader::Line& phi : now->phis) {
        bool found = false;
        for (size_t i = 0; i + 1 < phi.operands.size() && !found; i += 2) {
          if (phi.operands[i + 1] != before) continue;
          arriving.emplace_back(phi.id, values_.at(phi.operands[i]));
          found = true;
        }
        if (!found) unsupported("a phi for a predecessor of block", now->label);
      }
      for (auto& [id, value] : arriving) values_[id] = std::move(value);
      for (const shader::Line& line : now->lines) execute(line);
      before = now->label;
      const std::vector<uint32_t>& operands = now->end.operands;
      switch (now->end.op) {
        case Op::OpBranch:
          now = &module_.block(operands.at(0));
          break;
        case Op::OpBranchConditional:
          now = &module_.block(operands.at(decided(get(operands.at(0)).at(0)) != 0 ? 1 : 2));
          break;
        case Op::OpSwitch: {
          const uint32_t selector = decided(get(operands.at(0)).at(0));
          uint32_t target = operands.at(1);
          for (size_t i = 2; i + 1 < operands.size(); i += 2)
            if (operands[i] == selector) target = operands[i + 1];
          now = &module_.block(target);
          break;
        }
        case Op::OpReturn:
          return;
        case Op::OpUnreachable:
          throw UndefinedBehaviour("an unreachable place is reached");
        default:
          unsupported("the end of a block", static_cast<uint32_t>(now->end.op));
      }
    }
    throw UndefinedBehaviour("the shader does not end");
  }

  static uint32_t decided(const Word& word) {
    if (!word.known) throw UndefinedBehaviour("the shader branches on an undefined value");
    return word.bits;
  }

  // ---- values

  const Words& get(uint32_t id) const {
    const auto found = values_.find(id);
    if (found == values_.end()) unsupported("value", id);
    return found->second.words;
  }
  static void append(Words& to, const Words& from) { to.insert(to.end(), from.begin(), from.end()); }

  const Pointer& pointer(uint32_t id) const {
    const auto found = values_.find(id);
    if (found == values_.end() || !found->second.pointer) unsupported("pointer", id);
    return *found->second.pointer;
  }

  /// The scalar type of a scalar or vector.
  const shader::Type& scalar_type(uint32_t type) const {
    const shader::Type& its = module_.type(type);
    return its.kind == shader::TypeKind::Vector ? module_.type(its.element) : its;
  }
  uint32_t narrowed(uint32_t type, uint32_t bits) const {
    const shader::Type& its = scalar_type(type);
    if (its.kind != shader::TypeKind::Int || its.bits >= 32) return bits;
    bits &= (1u << its.bits) - 1;
    if (its.is_signed && (bits >> (its.bits - 1)) != 0) bits |= ~0u << its.bits;
    return bits;
  }
  uint32_t width_of(uint32_t id) const {
    const shader::Type& its = scalar_type(module_.type_of(id));
    return its.bits;
  }

  /// Component by component; `function` takes the bits of each operand, from `first` on.
  template <typename Function>
  void map1(const shader::Line& line, size_t first, const Function& function) {
    Words words;
    for (const Word& a : get(line.operands.at(first)))
      words.push_back(a.known ? known(narrowed(line.type, function(a.bits))) : Word{});
    values_[line.id].words = std::move(words);
  }
  template <typename Function>
  void map2(const shader::Line& line, size_t first, const Function& function) {
    const Words a = get(line.operands.at(first)), b = get(line.operands.at(first + 1));
    Words words;
    for (size_t i = 0; i < a.size(); ++i) {
      const Word& second = b.at(b.size() == 1 ? 0 : i);
      words.push_back(a[i].known && second.known ? known(narrowed(line.type, function(a[i].bits, second.bits)))
                                                 : Word{});
    }
    values_[line.id].words = std::move(words);
  }
  template <typename Function>
  void map3(const shader::Line& line, size_t first, const Function& function) {
    const Words a = get(line.operands.at(first)), b = get(line.operands.at(first + 1));
    const Words c = get(line.operands.at(first + 2));
    Words words;
    for (size_t i = 0; i < a.size(); ++i)
      words.push_back(a[i].known && b.at(i).known && c.at(i).known
                          ? known(narrowed(line.type, function(a[i].bits, b[i].bits, c[i].bits)))
                          : Word{});
    values_[line.id].words = std::move(words);
  }
  /// Of two operands; nothing where the result is undefined.
  template <typename Function>
  void partial2(const shader::Line& line, const Function& function) {
    const Words a = get(line.operands.at(0)), b = get(line.operands.at(1));
    Words words;
    for (size_t i = 0; i < a.size(); ++i) {
      Word result;
      if (a[i].known && b.at(i).known) {
        const std::optional<uint32_t> bits = function(a[i].bits, b[i].bits);
        if (bits) result = known(narrowed(line.type, *bits));
      }
      words.push_back(result);
    }
    values_[line.id].words = std::move(words);
  }

  static Word add(const Word& a, const Word& b) { return {arith::add(a.bits, b.bits, mode()), a.known && b.known}; }
  static Word sub(const Word& a, const Word& b) { return {arith::sub(a.bits, b.bits, mode()), a.known && b.known}; }
  static Word mul(const Word& a, const Word& b) { return {arith::mul(a.bits, b.bits, mode()), a.known && b.known}; }
  static Word root(const Word& a) { return {arith::sqrt(a.bits, mode()), a.known}; }
  static Word minus(const Word& a) { return {a.bits ^ 0x80000000u, a.known}; }
  static Word dot(const Words& a, const Words& b) {
    Word sum = mul(a.at(0), b.at(0));
    for (size_t i = 1; i < a.size(); ++i) sum = add(sum, mul(a[i], b.at(i)));
    return sum;
  }

  // ---- memory

  struct Strides {
    uint32_t matrix = 0, component = 4;
    bool row_major = false;
  };
  /// Calls visit(byte) for each scalar of a type in memory.
  template <typename Visit>
  void in_memory(uint32_t type, uint32_t byte, const Strides& strides, const Visit& visit) const {
    const shader::Type& its = module_.type(type);
    switch (its.kind) {
      case shader::TypeKind::Vector:
        for (uint32_t i = 0; i < its.count; ++i) visit(byte + i * strides.component);
        return;
      case shader::TypeKind::Matrix:
        for (uint32_t c = 0; c < its.count; ++c) {
          for (uint32_t r = 0; r < module_.type(its.element).count; ++r)
            visit(byte + (strides.row_major ? r * strides.matrix + c * 4 : c * strides.matrix + r * 4));
        }
        return;
      case shader::TypeKind::Array:
        for (uint32_t i = 0; i < its.count; ++i) in_memory(its.element, byte + i * its.stride, strides, visit);
        return;
      case shader::TypeKind::Struct:
        for (uint32_t m = 0; m < its.members.size(); ++m) {
          const shader::MemberLayout& layout = module_.layout(type, m);
          in_memory(its.members[m], byte + layout.offset, {layout.matrix_stride, 4, layout.row_major}, visit);
        }
        return;
      default:
        visit(byte);
        if (module_.is_wide(type)) visit(byte + 4);
    }
  }

  Pointer part(Pointer whole, const Word& index_word) const {
    const shader::Type& its = module_.type(whole.type);
    const uint32_t index = decided(index_word);
    if (its.count != 0 && index >= its.count) throw UndefinedBehaviour("an index is out of range");
    const bool in_words = whole.place == Place::Variable;
    if (its.kind == shader::TypeKind::Struct) {
      if (in_words) {
        for (uint32_t m = 0; m < index; ++m) whole.offset += module_.scalars(its.members.at(m));
      } else {
        const shader::MemberLayout& layout = module_.layout(whole.type, index);
        whole.offset += layout.offset;
        whole.matrix_stride = layout.matrix_stride;
        whole.row_major = layout.row_major;
        whole.component_stride = 4;
      }
      whole.type = its.members.at(index);
      return whole;
    }
    whole.type = its.element;
    if (in_words) {
      whole.offset += index * module_.scalars(its.element);
    } else if (whole.place == Place::Texture) {
      whole.offset += index * shader::kTextureBytes;
    } else if (its.kind == shader::TypeKind::Matrix) {
      whole.offset += index * (whole.row_major ? 4 : whole.matrix_stride);
      whole.component_stride = whole.row_major ? whole.matrix_stride : 4;
    } else if (its.kind == shader::TypeKind::Vector) {
      whole.offset += index * whole.component_stride;
    } else {
      whole.offset += index * its.stride;
    }
    return whole;
  }

  Words read(const Pointer& from) const {
    Words words;
    const Strides strides = {from.matrix_stride, from.component_stride, from.row_major};
    switch (from.place) {
      case Place::Variable:
        for (uint32_t i = 0; i < module_.scalars(from.type); ++i) words.push_back(from.variable->at(from.offset + i));
        return words;
      case Place::Memory:
        in_memory(from.type, from.offset, strides, [&](uint32_t byte) { words.push_back(known(memory_.load(byte))); });
        return words;
      case Place::Block:
        in_memory(from.type, from.offset, strides, [&](uint32_t byte) {
          if (byte / 4 >= from.block->size()) {
            words.push_back(Word{});
            return;
          }
          const shader::Word& word = (*from.block)[byte / 4];
          words.push_back(known(word.argument ? arguments_.at(*word.argument) : word.bits));
        });
        return words;
      default:
        return {known(from.offset)};  // a texture's record
    }
  }

  void write(const Pointer& to, const Words& words) {
    if (to.place == Place::Variable) {
      for (size_t i = 0; i < words.size(); ++i) to.variable->at(to.offset + i) = words[i];
      return;
    }
    if (to.place != Place::Memory) unsupported("a store to place", static_cast<uint32_t>(to.place));
    size_t next = 0;
    in_memory(to.type, to.offset, {to.matrix_stride, to.component_stride, to.row_major}, [&](uint32_t byte) {
      const Word& word = words.at(next++);
      if (!word.known) throw UndefinedBehaviour("an undefined value is stored to memory");
      memory_.store(byte, word.bits);
    });
  }

  static Pointer address(const Word& low, uint32_t type) {
    Pointer pointer;
    pointer.place = Place::Memory;
    pointer.type = type;
    pointer.offset = decided(low);
    return pointer;
  }

  // ---- instructions

  // NOLINTNEXTLINE(readability-function-size): a list
  void execute(const shader::Line& line) {
    const std::vector<uint32_t>& o = line.operands;
    const auto f2 = [&](uint32_t (*function)(uint32_t, uint32_t, arith::Mode)) {
      map2(line, 0, [&](uint32_t a, uint32_t b) { return function(a, b, mode()); });
    };
    const auto condition = [&](bool (*function)(uint32_t, uint32_t, arith::Mode), bool or_nan) {
      map2(line, 0, [&](uint32_t a, uint32_t b) {
        if (arith::detail::is_nan(a) || arith::detail::is_nan(b)) return or_nan ? 1u : 0u;
        return function(a, b, mode()) ? 1u : 0u;
      });
    };
    const auto integers = [&](const auto& function) { map2(line, 0, function); };
    const auto compare = [&](const auto& function) {
      map2(line, 0, [&](uint32_t a, uint32_t b) { return function(a, b) ? 1u : 0u; });
    };
    const auto compare_signed = [&](const auto& function) {
      map2(line, 0, [&](uint32_t a, uint32_t b) {
        return function(static_cast<int32_t>(a), static_cast<int32_t>(b)) ? 1u : 0u;
      });
    };
    if (wide(line)) return;
    switch (line.op) {
      case Op::OpReadClockKHR:
        values_[line.id].words = {known(arguments_[argument::kSample]), known(0)};
        return;
      // pointers
      case Op::OpAccessChain:
      case Op::OpInBoundsAccessChain: {
        Pointer to = pointer(o.at(0));
        for (size_t i = 1; i < o.size(); ++i) to = part(to, get(o[i]).at(0));
        values_[line.id].pointer = to;
        return;
      }
      case Op::OpLoad: {
        const Pointer from = pointer(o.at(0));
        Value value;
        if (module_.type(line.type).kind == shader::TypeKind::Pointer)
          value.pointer = address(read(from).at(0), module_.type(line.type).element);
        else
          value.words = read(from);
        if (from.place == Place::Picture) value.pointer = from;
        values_[line.id] = value;
        return;
      }
      case Op::OpStore:
        write(pointer(o.at(0)), get(o.at(1)));
        return;
      case Op::OpCopyObject:
      case Op::OpCopyLogical:
      case Op::OpImage:
        values_[line.id] = values_.at(o.at(0));
        return;
      case Op::OpUndef:
        values_[line.id].words.assign(module_.scalars(line.type), Word{});
        return;
      case Op::OpConvertUToPtr:
        values_[line.id].pointer = address(get(o.at(0)).at(0), module_.type(line.type).element);
        return;
      case Op::OpBitcast:
        if (module_.type(line.type).kind == shader::TypeKind::Pointer)
          values_[line.id].pointer = address(get(o.at(0)).at(0), module_.type(line.type).element);
        else
          map1(line, 0, [](uint32_t a) { return a; });
        return;
      case Op::OpArrayLength: {
        const Pointer whole = pointer(o.at(0));
        const uint32_t offset = module_.layout(whole.type, o.at(1)).offset;
        const uint32_t stride = module_.type(module_.type(whole.type).members.at(o[1])).stride;
        values_[line.id].words = {known((ends_.at(o[0]) - offset) / stride)};
        return;
      }
      case Op::OpConvertPtrToU:
        values_[line.id].words.assign(module_.scalars(line.type), known(0));
        values_[line.id].words.at(0) = known(pointer(o.at(0)).offset);
        return;
      // rays and pictures
      case Op::OpExecuteCallableKHR:
        return execute_callable(line);
      case Op::OpTraceRayKHR:
        return trace(line);
      case Op::OpImageWrite:
        return contribute(line);
      case Op::OpImageSampleExplicitLod:
      case Op::OpImageSampleImplicitLod:
      case Op::OpImageFetch:
        return texels(line);
      case Op::OpImageQuerySizeLod:
      case Op::OpImageQuerySize: {
        const Value& image = values_.at(o.at(0));
        if (image.pointer) {
          values_[line.id].words = {known(resources_.width), known(resources_.height)};
        } else {
          const uint32_t record = decided(image.words.at(0));
          values_[line.id].words = {known(memory_.load(record + 4)), known(memory_.load(record + 8))};
        }
        return;
      }
      case Op::OpExtInst:
        if (module_.is_glsl_set(o.at(0))) glsl(line);
        return;
      // floats
      case Op::OpFAdd:
        return f2(arith::add);
      case Op::OpFSub:
        return f2(arith::sub);
      case Op::OpFMul:
      case Op::OpVectorTimesScalar:
      case Op::OpMatrixTimesScalar:
        return f2(arith::mul);
      case Op::OpFDiv:
        return f2(arith::div);
      case Op::OpFNegate:
        return map1(line, 0, [](uint32_t a) { return a ^ 0x80000000u; });
      case Op::OpFMod:
        return floats2(line, 0, [](Native& k, Float x, Float y) { return shader::math::mod(k, x, y); });
      case Op::OpFRem:
        return floats2(line, 0, [](Native& k, Float x, Float y) { return shader::math::rem(k, x, y); });
      case Op::OpFOrdEqual:
        return condition(arith::equal, false);
      case Op::OpFUnordEqual:
        return condition(arith::equal, true);
      case Op::OpFOrdNotEqual:
        return condition(arith::not_equal, false);
      case Op::OpFUnordNotEqual:
        return condition(arith::not_equal, true);
      case Op::OpFOrdLessThan:
        return condition(arith::less, false);
      case Op::OpFUnordLessThan:
        return condition(arith::less, true);
      case Op::OpFOrdLessThanEqual:
        return condition(arith::less_equal, false);
      case Op::OpFUnordLessThanEqual:
        return condition(arith::less_equal, true);
      case Op::OpFOrdGreaterThan:
        return condition(arith::greater, false);
      case Op::OpFUnordGreaterThan:
        return condition(arith::greater, true);
      case Op::OpFOrdGreaterThanEqual:
        return condition(arith::greater_equal, false);
      case Op::OpFUnordGreaterThanEqual:
        return condition(arith::greater_equal, true);
      case Op::OpIsNan:
        return map1(line, 0, [](uint32_t a) { return std::isnan(as_float(a)) ? 1u : 0u; });
      case Op::OpIsInf:
        return map1(line, 0, [](uint32_t a) { return std::isinf(as_float(a)) ? 1u : 0u; });
      // integers
      case Op::OpIAdd:
        return integers([](uint32_t a, uint32_t b) { return a + b; });
      case Op::OpISub:
        return integers([](uint32_t a, uint32_t b) { return a - b; });
      case Op::OpIMul:
        return integers([](uint32_t a, uint32_t b) { return a * b; });
      case Op::OpSNegate:
        return map1(line, 0, [](uint32_t a) { return 0 - a; });
      case Op::OpNot:
        return map1(line, 0, [](uint32_t a) { return ~a; });
      case Op::OpBitwiseAnd:
        return integers([](uint32_t a, uint32_t b) { return a & b; });
      case Op::OpBitwiseOr:
        return integers([](uint32_t a, uint32_t b) { return a | b; });
      case Op::OpBitwiseXor:
        return integers([](uint32_t a, uint32_t b) { return a ^ b; });
      case Op::OpUDiv:
        return partial2(line, [](uint32_t a, uint32_t b) { return b == 0 ? std::nullopt : std::optional(a / b); });
      case Op::OpUMod:
        return partial2(line, [](uint32_t a, uint32_t b) { return b == 0 ? std::nullopt : std::optional(a % b); });
      case Op::OpSDiv:
      case Op::OpSRem:
      case Op::OpSMod:
        return partial2(line, [&](uint32_t a, uint32_t b) -> std::optional<uint32_t> {
          const int64_t x = static_cast<int32_t>(a), y = static_cast<int32_t>(b);
          if (y == 0 || (x == INT32_MIN && y == -1)) return std::nullopt;
          int64_t result = line.op == Op::OpSDiv ? x / y : x % y;
          if (line.op == Op::OpSMod && result != 0 && (result < 0) != (y < 0)) result += y;
          return static_cast<uint32_t>(result);
        });
      case Op::OpShiftLeftLogical:
      case Op::OpShiftRightLogical:
      case Op::OpShiftRightArithmetic: {
        const uint32_t width = width_of(o.at(0));
        return partial2(line, [&](uint32_t a, uint32_t b) -> std::optional<uint32_t> {
          if (b >= width) return std::nullopt;
          if (line.op == Op::OpShiftLeftLogical) return a << b;
          if (line.op == Op::OpShiftRightArithmetic) return static_cast<uint32_t>(static_cast<int32_t>(a) >> b);
          return (width == 32 ? a : a & ((1u << width) - 1)) >> b;
        });
      }
      case Op::OpBitReverse:
        return map1(line, 0, [](uint32_t a) {
          uint32_t bits = 0;
          for (uint32_t i = 0; i < 32; ++i) bits |= (a >> i & 1) << (31 - i);
          return bits;
        });
      case Op::OpBitCount:
        return map1(line, 0, [](uint32_t a) {
          uint32_t count = 0;
          for (uint32_t i = 0; i < 32; ++i) count += a >> i & 1;
          return count;
        });
      case Op::OpBitFieldInsert:
      case Op::OpBitFieldSExtract:
      case Op::OpBitFieldUExtract:
        return bit_field(line);
      case Op::OpIAddCarry:
      case Op::OpISubBorrow:
      case Op::OpUMulExtended:
      case Op::OpSMulExtended:
        return two_results(line);
      case Op::OpIEqual:
      case Op::OpLogicalEqual:
        return compare([](uint32_t a, uint32_t b) { return a == b; });
      case Op::OpINotEqual:
      case Op::OpLogicalNotEqual:
        return compare([](uint32_t a, uint32_t b) { return a != b; });
      case Op::OpULessThan:
        return compare([](uint32_t a, uint32_t b) { return a < b; });
      case Op::OpULessThanEqual:
        return compare([](uint32_t a, uint32_t b) { return a <= b; });
      case Op::OpUGreaterThan:
        return compare([](uint32_t a, uint32_t b) { return a > b; });
      case Op::OpUGreaterThanEqual:
        return compare([](uint32_t a, uint32_t b) { return a >= b; });
      case Op::OpSLessThan:
        return compare_signed([](int32_t a, int32_t b) { return a < b; });
      case Op::OpSLessThanEqual:
        return compare_signed([](int32_t a, int32_t b) { return a <= b; });
      case Op::OpSGreaterThan:
        return compare_signed([](int32_t a, int32_t b) { return a > b; });
      case Op::OpSGreaterThanEqual:
        return compare_signed([](int32_t a, int32_t b) { return a >= b; });
      // conversions
      case Op::OpConvertFToS:
        return map1(line, 0, [](uint32_t a) { return arith::to_int(a, mode()); });
      case Op::OpConvertFToU:
        return integer_of(line, 0, [](Native& k, Float x) { return shader::math::float_to_unsigned(k, x); });
      case Op::OpConvertSToF:
        return map1(line, 0, [](uint32_t a) { return as_bits(static_cast<float>(static_cast<int32_t>(a))); });
      case Op::OpConvertUToF:
        return map1(line, 0, [](uint32_t a) { return as_bits(static_cast<float>(a)); });
      case Op::OpUConvert: {
        const uint32_t width = width_of(o.at(0));
        return map1(line, 0, [&](uint32_t a) { return width == 32 ? a : a & ((1u << width) - 1); });
      }
      case Op::OpSConvert: {
        const uint32_t unused = 32 - width_of(o.at(0));
        return map1(line, 0,
                    [&](uint32_t a) { return static_cast<uint32_t>(static_cast<int32_t>(a << unused) >> unused); });
      }
      // conditions
      case Op::OpLogicalAnd:
        return integers([](uint32_t a, uint32_t b) { return a & b; });
      case Op::OpLogicalOr:
        return integers([](uint32_t a, uint32_t b) { return a | b; });
      case Op::OpLogicalNot:
        return map1(line, 0, [](uint32_t a) { return a == 0 ? 1u : 0u; });
      case Op::OpAny:
      case Op::OpAll: {
        Word result = known(line.op == Op::OpAll ? 1 : 0);
        for (const Word& word : get(o.at(0))) {
          result.bits = line.op == Op::OpAll ? result.bits & word.bits : result.bits | word.bits;
          result.known = result.known && word.known;
        }
        values_[line.id].words = {result};
        return;
      }
      case Op::OpSelect: {
        const Words chosen = get(o.at(0)), a = get(o.at(1)), b = get(o.at(2));
        Words words;
        for (size_t i = 0; i < a.size(); ++i) {
          const Word& which = chosen.at(chosen.size() == 1 ? 0 : i);
          words.push_back(!which.known ? Word{} : which.bits != 0 ? a[i] : b.at(i));
        }
        values_[line.id].words = std::move(words);
        return;
      }
      default:
        return composite(line);
    }
  }

  // NOLINTNEXTLINE(readability-function-size): a list
  void composite(const shader::Line& line) {
    const std::vector<uint32_t>& o = line.operands;
    /// Offset and type of what literal indices name, from operand `first` on.
    const auto place = [&](uint32_t type, size_t first) {
      size_t offset = 0;
      for (size_t i = first; i < o.size(); ++i) {
        const shader::Type& its = module_.type(type);
        const bool is_struct = its.kind == shader::TypeKind::Struct;
        for (uint32_t before = 0; before < o[i]; ++before)
          offset += module_.scalars(is_struct ? its.members.at(before) : its.element);
        type = is_struct ? its.members.at(o[i]) : its.element;
      }
      return offset;
    };
    Words words;
    switch (line.op) {
      case Op::OpCompositeConstruct:
        for (const uint32_t id : o) append(words, get(id));
        break;
      case Op::OpCompositeExtract: {
        const Words& whole = get(o.at(0));
        const size_t offset = place(module_.type_of(o[0]), 1);
        for (size_t i = 0; i < module_.scalars(line.type); ++i) words.push_back(whole.at(offset + i));
        break;
      }
      case Op::OpCompositeInsert: {
        words = get(o.at(1));
        const size_t offset = place(line.type, 2);
        const Words& inserted = get(o.at(0));
        for (size_t i = 0; i < inserted.size(); ++i) words.at(offset + i) = inserted[i];
        break;
      }
      case Op::OpVectorShuffle: {
        Words both = get(o.at(0));
        append(both, get(o.at(1)));
        for (size_t i = 2; i < o.size(); ++i) words.push_back(o[i] == 0xffffffffu ? Word{} : both.at(o[i]));
        break;
      }
      case Op::OpVectorExtractDynamic: {
        const uint32_t index = decided(get(o.at(1)).at(0));
        if (index >= get(o.at(0)).size()) throw UndefinedBehaviour("an index is out of range");
        words = {get(o[0])[index]};
        break;
      }
      case Op::OpVectorInsertDynamic: {
        words = get(o.at(0));
        const uint32_t index = decided(get(o.at(2)).at(0));
        if (index >= words.size()) throw UndefinedBehaviour("an index is out of range");
        words[index] = get(o.at(1)).at(0);
        break;
      }
      case Op::OpDot:
        words = {dot(get(o.at(0)), get(o.at(1)))};
        break;
      case Op::OpMatrixTimesVector: {
        const Words &matrix = get(o.at(0)), &vector = get(o.at(1));
        const size_t rows = matrix.size() / vector.size();
        for (size_t r = 0; r < rows; ++r) words.push_back(row_times(matrix, rows, r, vector, 0, vector.size()));
        break;
      }
      case Op::OpVectorTimesMatrix: {
        const Words &vector = get(o.at(0)), &matrix = get(o.at(1));
        for (size_t c = 0; c < matrix.size(); c += vector.size()) {
          Word sum = mul(vector[0], matrix[c]);
          for (size_t i = 1; i < vector.size(); ++i) sum = add(sum, mul(vector[i], matrix[c + i]));
          words.push_back(sum);
        }
        break;
      }
      case Op::OpMatrixTimesMatrix: {
        const Words &a = get(o.at(0)), &b = get(o.at(1));
        const size_t columns = module_.type(line.type).count;
        const size_t rows = module_.scalars(module_.type(line.type).element), inner = b.size() / columns;
        for (size_t c = 0; c < columns; ++c)
          for (size_t r = 0; r < rows; ++r) words.push_back(row_times(a, rows, r, b, c * inner, inner));
        break;
      }
      case Op::OpOuterProduct:
        for (const Word& column : get(o.at(1)))
          for (const Word& row : get(o.at(0))) words.push_back(mul(row, column));
        break;
      case Op::OpTranspose: {
        const Words& matrix = get(o.at(0));
        const size_t columns = module_.type(line.type).count, rows = matrix.size() / columns;
        for (size_t c = 0; c < columns; ++c)
          for (size_t r = 0; r < rows; ++r) words.push_back(matrix.at(r * columns + c));
        break;
      }
      default:
        unsupported("instruction", static_cast<uint32_t>(line.op));
    }
    values_[line.id].words = std::move(words);
  }

  /// A row of a matrix times `size` words of a vector from `first` on.
  static Word row_times(const Words& matrix, size_t rows, size_t row, const Words& vector, size_t first, size_t size) {
    Word sum = mul(matrix.at(row), vector.at(first));
    for (size_t i = 1; i < size; ++i) sum = add(sum, mul(matrix.at(i * rows + row), vector.at(first + i)));
    return sum;
  }

  void bit_field(const shader::Line& line) {
    const bool inserts = line.op == Op::OpBitFieldInsert;
    const Words base = get(line.operands.at(0)), inserted = inserts ? get(line.operands.at(1)) : base;
    const Word offset = get(line.operands.at(inserts ? 2 : 1)).at(0);
    const Word count = get(line.operands.at(inserts ? 3 : 2)).at(0);
    Words words(base.size());
    const bool defined = offset.known && count.known && uint64_t{offset.bits} + count.bits <= 32;
    for (size_t i = 0; defined && i < base.size(); ++i) {
      if (!base[i].known || !inserted[i].known) continue;
      uint32_t bits = inserts ? base[i].bits : 0;
      for (uint32_t n = 0; n < count.bits; ++n) {
        const uint32_t bit = inserts ? inserted[i].bits >> n & 1 : base[i].bits >> (offset.bits + n) & 1;
        const uint32_t at = inserts ? offset.bits + n : n;
        bits = (bits & ~(1u << at)) | bit << at;
      }
      if (line.op == Op::OpBitFieldSExtract && count.bits > 0 && (bits >> (count.bits - 1) & 1) != 0)
        for (uint32_t n = count.bits; n < 32; ++n) bits |= 1u << n;
      words[i] = known(bits);
    }
    values_[line.id].words = std::move(words);
  }

  /// Instructions whose result is a struct of two.
  void two_results(const shader::Line& line) {
    const Words a = get(line.operands.at(0)), b = get(line.operands.at(1));
    Words words(2 * a.size());
    for (size_t i = 0; i < a.size(); ++i) {
      if (!a[i].known || !b.at(i).known) continue;
      const uint64_t x = a[i].bits, y = b[i].bits;
      uint64_t low = 0, high = 0;
      switch (line.op) {
        case Op::OpIAddCarry:
          low = x + y;
          high = low >> 32;
          break;
        case Op::OpISubBorrow:
          low = x - y;
          high = x < y ? 1 : 0;
          break;
        case Op::OpUMulExtended:
          low = x * y;
          high = low >> 32;
          break;
        default:
          low = static_cast<uint64_t>(int64_t{static_cast<int32_t>(a[i].bits)} * static_cast<int32_t>(b[i].bits));
          high = low >> 32;
      }
      words[i] = known(static_cast<uint32_t>(low));
      words[a.size() + i] = known(static_cast<uint32_t>(high));
    }
    values_[line.id].words = std::move(words);
  }

  // ---- GLSL.std.450

  template <typename Function>
  void floats1(const shader::Line& line, size_t first, const Function& function) {
    Native k(native_);
    map1(line, first, [&](uint32_t a) { return function(k, Float::of_bits(a)).bits; });
  }
  template <typename Function>
  void floats2(const shader::Line& line, size_t first, const Function& function) {
    Native k(native_);
    map2(line, first, [&](uint32_t a, uint32_t b) { return function(k, Float::of_bits(a), Float::of_bits(b)).bits; });
  }
  template <typename Function>
  void integer_of(const shader::Line& line, size_t first, const Function& function) {
    Native k(native_);
    map1(line, first, [&](uint32_t a) { return function(k, Float::of_bits(a)).bits; });
  }

  /// To where the last operand points, or behind the first result.
  void second_result(const shader::Line& line, const Words& first, const Words& second, bool by_pointer) {
    Words words = first;
    if (by_pointer)
      write(pointer(line.operands.back()), second);
    else
      append(words, second);
    values_[line.id].words = std::move(words);
  }

  // NOLINTNEXTLINE(readability-function-size): a list
  void glsl(const shader::Line& line) {
    namespace math = shader::math;
    using K = Native;
    const std::vector<uint32_t>& o = line.operands;
    const auto one = [&](Float (*function)(K&, const Float&)) { floats1(line, 2, function); };
    const auto two = [&](Float (*function)(K&, const Float&, const Float&)) { floats2(line, 2, function); };
    const auto three = [&](Float (*function)(K&, const Float&, const Float&, const Float&)) {
      K k(native_);
      map3(line, 2, [&](uint32_t a, uint32_t b, uint32_t c) {
        return function(k, Float::of_bits(a), Float::of_bits(b), Float::of_bits(c)).bits;
      });
    };
    const auto result = [&](Words words) { values_[line.id].words = std::move(words); };
    const auto both_results = [&](auto first, auto second, bool by_pointer) {
      K k(native_);
      Words a, b;
      for (const Word& word : get(o.at(2))) {
        a.push_back({first(k, Float::of_bits(word.bits)).bits, word.known});
        b.push_back({second(k, Float::of_bits(word.bits)).bits, word.known});
      }
      second_result(line, a, b, by_pointer);
    };
    switch (o.at(1)) {
      case GLSLstd450Round:
      case GLSLstd450RoundEven:
        return one(math::round<K>);
      case GLSLstd450Trunc:
        return one(math::trunc<K>);
      case GLSLstd450FAbs:
        return map1(line, 2, [](uint32_t a) { return a & 0x7fffffffu; });
      case GLSLstd450FSign:
        return floats1(line, 2, [](K& k, const Float& x) { return math::sign(k, x); });
      case GLSLstd450Floor:
        return one(math::floor<K>);
      case GLSLstd450Ceil:
        return one(math::ceil<K>);
      case GLSLstd450Fract:
        return one(math::fract<K>);
      case GLSLstd450Radians:
        return one(math::radians<K>);
      case GLSLstd450Degrees:
        return one(math::degrees<K>);
      case GLSLstd450Sin:
        return one(math::sin<K>);
      case GLSLstd450Cos:
        return one(math::cos<K>);
      case GLSLstd450Tan:
        return one(math::tan<K>);
      case GLSLstd450Asin:
        return one(math::asin<K>);
      case GLSLstd450Acos:
        return one(math::acos<K>);
      case GLSLstd450Atan:
        return one(math::atan<K>);
      case GLSLstd450Sinh:
        return one(math::sinh<K>);
      case GLSLstd450Cosh:
        return one(math::cosh<K>);
      case GLSLstd450Tanh:
        return one(math::tanh<K>);
      case GLSLstd450Asinh:
        return one(math::asinh<K>);
      case GLSLstd450Acosh:
        return one(math::acosh<K>);
      case GLSLstd450Atanh:
        return one(math::atanh<K>);
      case GLSLstd450Exp:
        return one(math::exp<K>);
      case GLSLstd450Log:
        return one(math::log<K>);
      case GLSLstd450Exp2:
        return one(math::exp2<K>);
      case GLSLstd450Log2:
        return one(math::log2<K>);
      case GLSLstd450Atan2:
        return two(math::atan2<K>);
      case GLSLstd450Pow:
        return two(math::pow<K>);
      case GLSLstd450Step:
        return two(math::step<K>);
      case GLSLstd450FMix:
        return three(math::mix<K>);
      case GLSLstd450SmoothStep:
        return three(math::smoothstep<K>);
      case GLSLstd450Sqrt:
        return map1(line, 2, [](uint32_t a) { return arith::sqrt(a, mode()); });
      case GLSLstd450InverseSqrt:
        return map1(line, 2, [](uint32_t a) { return arith::rsqrt(a, mode()); });
      case GLSLstd450FMin:
      case GLSLstd450NMin:
        return map2(line, 2, [](uint32_t a, uint32_t b) { return arith::min(a, b, mode()); });
      case GLSLstd450FMax:
      case GLSLstd450NMax:
        return map2(line, 2, [](uint32_t a, uint32_t b) { return arith::max(a, b, mode()); });
      case GLSLstd450FClamp:
      case GLSLstd450NClamp:
        return map3(line, 2, [](uint32_t x, uint32_t least, uint32_t most) {
          return arith::min(arith::max(x, least, mode()), most, mode());
        });
      case GLSLstd450Fma:
        return map3(line, 2,
                    [](uint32_t a, uint32_t b, uint32_t c) { return arith::add(arith::mul(a, b, mode()), c, mode()); });
      case GLSLstd450Modf:
      case GLSLstd450ModfStruct:
        return both_results([](K& k, Float x) { return math::modf_fraction(k, x); },
                            [](K& k, Float x) { return math::trunc(k, x); }, o[1] == GLSLstd450Modf);
      case GLSLstd450Frexp:
      case GLSLstd450FrexpStruct:
        return both_results([](K& k, Float x) { return math::frexp_significand(k, x); },
                            [](K& k, Float x) { return math::frexp_exponent(k, x); }, o[1] == GLSLstd450Frexp);
      case GLSLstd450Ldexp: {
        K k(native_);
        return map2(line, 2, [&](uint32_t x, uint32_t n) { return math::ldexp(k, Float::of_bits(x), Int(n)).bits; });
      }
      case GLSLstd450SAbs:
        return map1(line, 2, [](uint32_t a) { return (a >> 31) != 0 ? 0 - a : a; });
      case GLSLstd450SSign:
        return map1(line, 2, [](uint32_t a) { return a == 0 ? 0u : (a >> 31) != 0 ? ~0u : 1u; });
      case GLSLstd450UMin:
        return map2(line, 2, [](uint32_t a, uint32_t b) { return a < b ? a : b; });
      case GLSLstd450UMax:
        return map2(line, 2, [](uint32_t a, uint32_t b) { return a < b ? b : a; });
      case GLSLstd450SMin:
        return map2(line, 2, [](uint32_t a, uint32_t b) { return less_signed(a, b) ? a : b; });
      case GLSLstd450SMax:
        return map2(line, 2, [](uint32_t a, uint32_t b) { return less_signed(a, b) ? b : a; });
      case GLSLstd450UClamp:
        return map3(line, 2, [](uint32_t x, uint32_t least, uint32_t most) {
          const uint32_t above = x < least ? least : x;
          return above > most ? most : above;
        });
      case GLSLstd450SClamp:
        return map3(line, 2, [](uint32_t x, uint32_t least, uint32_t most) {
          const uint32_t above = less_signed(x, least) ? least : x;
          return less_signed(most, above) ? most : above;
        });
      case GLSLstd450FindILsb:
        return map1(line, 2, [](uint32_t a) {
          for (uint32_t i = 0; i < 32; ++i)
            if ((a >> i & 1) != 0) return i;
          return ~0u;
        });
      case GLSLstd450FindUMsb:
        return map1(line, 2, highest_bit);
      case GLSLstd450FindSMsb:
        return map1(line, 2, [](uint32_t a) { return highest_bit((a >> 31) != 0 ? ~a : a); });
      case GLSLstd450Length: {
        const Words& x = get(o.at(2));
        return result({length(x)});
      }
      case GLSLstd450Distance: {
        Words difference;
        for (size_t i = 0; i < get(o.at(2)).size(); ++i) difference.push_back(sub(get(o[2])[i], get(o.at(3)).at(i)));
        return result({length(difference)});
      }
      case GLSLstd450Normalize: {
        const Words x = get(o.at(2));
        if (x.size() == 1) return floats1(line, 2, [](K& k, const Float& value) { return math::sign(k, value); });
        const Word square = dot(x, x), inverse = {arith::rsqrt(square.bits, mode()), square.known};
        Words words;
        for (const Word& word : x) words.push_back(mul(word, inverse));
        return result(words);
      }
      case GLSLstd450Cross: {
        const Words a = get(o.at(2)), b = get(o.at(3));
        return result({sub(mul(a.at(1), b.at(2)), mul(a.at(2), b.at(1))),
                       sub(mul(a.at(2), b.at(0)), mul(a.at(0), b.at(2))),
                       sub(mul(a.at(0), b.at(1)), mul(a.at(1), b.at(0)))});
      }
      case GLSLstd450FaceForward: {
        const Words n = get(o.at(2)), incident = get(o.at(3)), reference = get(o.at(4));
        const Word along = dot(reference, incident);
        Words words;
        for (const Word& word : n) {
          const Word turned = arith::less(along.bits, 0, mode()) ? word : minus(word);
          words.push_back({turned.bits, turned.known && along.known});
        }
        return result(words);
      }
      case GLSLstd450Reflect: {
        const Words incident = get(o.at(2)), n = get(o.at(3));
        const Word twice = mul(dot(n, incident), of(-2.0f));
        Words words;
        for (size_t i = 0; i < n.size(); ++i) words.push_back(add(mul(twice, n[i]), incident[i]));
        return result(words);
      }
      case GLSLstd450Refract: {
        const Words incident = get(o.at(2)), n = get(o.at(3));
        const Word eta = get(o.at(4)).at(0), cosine = dot(n, incident);
        const Word k = sub(of(1.0f), mul(mul(eta, eta), sub(of(1.0f), mul(cosine, cosine))));
        Words words;
        for (size_t i = 0; i < n.size(); ++i) {
          if (arith::less(k.bits, 0, mode())) {
            words.push_back({0, k.known});
            continue;
          }
          const Word along = add(mul(eta, cosine), root({k.bits == 0x80000000u ? 0 : k.bits, k.known}));
          words.push_back(sub(mul(eta, incident[i]), mul(along, n[i])));
        }
        return result(words);
      }
      case GLSLstd450Determinant:
        return result({determinant(get(o.at(2)))});
      case GLSLstd450MatrixInverse: {
        const Words m = get(o.at(2));
        const size_t size = m.size() == 4 ? 2 : m.size() == 9 ? 3 : 4;
        const Word whole = determinant(m), factor = {arith::rcp(whole.bits, mode()), whole.known};
        Words words;
        for (size_t column = 0; column < size; ++column) {
          for (size_t row = 0; row < size; ++row) {
            const Word cofactor = mul(determinant(minor_of(m, size, column, row)), factor);
            words.push_back((row + column) % 2 != 0 ? minus(cofactor) : cofactor);
          }
        }
        return result(words);
      }
      default:
        return packing(line);
    }
  }

  void packing(const shader::Line& line) {
    namespace math = shader::math;
    const Words& a = get(line.operands.at(2));
    Native k(native_);
    const auto f = [&](size_t i) { return Float::of_bits(a.at(i).bits); };
    const Int packed(a.at(0).bits);
    bool defined = true;
    for (const Word& word : a) defined = defined && word.known;
    std::vector<uint32_t> bits;
    const auto pair = [&](const auto& both) { bits = {both.x.bits, both.y.bits}; };
    const auto quad = [&](const auto& all) { bits = {all.x.bits, all.y.bits, all.z.bits, all.w.bits}; };
    switch (line.operands.at(1)) {
      case GLSLstd450PackHalf2x16:
        bits = {math::pack_half_2x16(k, f(0), f(1)).bits};
        break;
      case GLSLstd450PackUnorm2x16:
        bits = {math::pack_unorm_2x16(k, f(0), f(1)).bits};
        break;
      case GLSLstd450PackSnorm2x16:
        bits = {math::pack_snorm_2x16(k, f(0), f(1)).bits};
        break;
      case GLSLstd450PackUnorm4x8:
        bits = {math::pack_unorm_4x8(k, f(0), f(1), f(2), f(3)).bits};
        break;
      case GLSLstd450PackSnorm4x8:
        bits = {math::pack_snorm_4x8(k, f(0), f(1), f(2), f(3)).bits};
        break;
      case GLSLstd450UnpackHalf2x16:
        pair(math::unpack_half_2x16(k, packed));
        break;
      case GLSLstd450UnpackUnorm2x16:
        pair(math::unpack_unorm_2x16(k, packed));
        break;
      case GLSLstd450UnpackSnorm2x16:
        pair(math::unpack_snorm_2x16(k, packed));
        break;
      case GLSLstd450UnpackUnorm4x8:
        quad(math::unpack_unorm_4x8(k, packed));
        break;
      case GLSLstd450UnpackSnorm4x8:
        quad(math::unpack_snorm_4x8(k, packed));
        break;
      default:
        unsupported("function of GLSL.std.450", line.operands.at(1));
    }
    Words words;
    for (const uint32_t word : bits) words.push_back({word, defined});
    values_[line.id].words = std::move(words);
  }

  static bool less_signed(uint32_t a, uint32_t b) { return static_cast<int32_t>(a) < static_cast<int32_t>(b); }
  static uint32_t highest_bit(uint32_t a) {
    for (uint32_t i = 32; i-- > 0;)
      if ((a >> i & 1) != 0) return i;
    return ~0u;
  }
  static Word length(const Words& x) {
    if (x.size() == 1) return {x[0].bits & 0x7fffffffu, x[0].known};
    return root(dot(x, x));
  }
  /// By cofactors of the first row; of a matrix by columns.
  static Word determinant(const Words& m) {
    if (m.size() == 1) return m[0];
    if (m.size() == 4) return sub(mul(m[0], m[3]), mul(m[2], m[1]));
    const size_t size = m.size() == 9 ? 3 : 4;
    Word sum;
    for (size_t c = 0; c < size; ++c) {
      const Word term = mul(m[c * size], determinant(minor_of(m, size, 0, c)));
      sum = c == 0 ? term : c % 2 != 0 ? sub(sum, term) : add(sum, term);
    }
    return sum;
  }
  static Words minor_of(const Words& m, size_t size, size_t row, size_t column) {
    Words rest;
    for (size_t i = 0; i < m.size(); ++i)
      if (i / size != column && i % size != row) rest.push_back(m[i]);
    return rest;
  }

  // ---- what leaves

  void execute_callable(const shader::Line& line) {
    const uint32_t index = decided(get(line.operands.at(0)).at(0));
    if (index >= callables.size()) throw UndefinedBehaviour("a callable shader is called that there is not");
    const Pointer& data = pointer(line.operands.at(1));
    SpirvThread called(*callables[index], resources_, kernel_, arguments_, memory_);
    called.thread = thread;
    called.block = block;
    called.input = input;
    called.callables = callables;
    called.callable_data = read(data);
    called.run();
    called.callable_data->resize(module_.scalars(data.type));
    write(data, *called.callable_data);
  }

  /// Arithmetic of 64-bit integers.
  bool wide(const shader::Line& line) {
    const auto is_wide = [&](uint32_t type) { return type != 0 && module_.is_wide(type); };
    if (line.operands.empty()) return false;
    const bool gives = is_wide(line.type), takes = is_wide(module_.type_of(line.operands[0]));
    if (!gives && !takes) return false;
    const auto of = [&](size_t i) -> uint64_t {
      const Words words = get(line.operands.at(i));
      const auto high = words.size() > 1 ? decided(words[1]) : 0;
      return uint64_t{high} << 32 | decided(words.at(0));
    };
    const auto give = [&](uint64_t value) {
      Words& words = values_[line.id].words;
      words = {known(static_cast<uint32_t>(value))};
      if (gives) words.push_back(known(static_cast<uint32_t>(value >> 32)));
      return true;
    };
    switch (line.op) {
      case Op::OpIAdd:
        return give(of(0) + of(1));
      case Op::OpISub:
        return give(of(0) - of(1));
      case Op::OpIMul:
        return give(of(0) * of(1));
      case Op::OpShiftLeftLogical:
        return give(of(0) << of(1));
      case Op::OpShiftRightLogical:
        return give(of(0) >> of(1));
      case Op::OpUConvert:
        return give(of(0));
      case Op::OpSConvert:
        return give(takes ? of(0) : static_cast<uint64_t>(int64_t{static_cast<int32_t>(of(0))}));
      case Op::OpIEqual:
        return give(of(0) == of(1) ? 1 : 0);
      case Op::OpINotEqual:
        return give(of(0) != of(1) ? 1 : 0);
      default:
        return false;
    }
  }

  void trace(const shader::Line& line) {
    const std::vector<uint32_t>& o = line.operands;
    const bool shadow = (decided(get(o.at(1)).at(0)) & 12u) == 12u;
    if (!shadow && kernel_ == RayKernel::CastSecondaryDirect) return;
    Words origin = get(o.at(6));
    const Words direction = get(o.at(8));
    const Word tmin = get(o.at(7)).at(0);
    Word tmax = get(o.at(9)).at(0);
    if (decided(tmin) != 0) {
      for (size_t i = 0; i < 3; ++i) origin.at(i) = add(mul(direction.at(i), tmin), origin[i]);
      tmax = sub(tmax, tmin);
    }
    OracleRay ray;
    const auto put = [&](size_t number, const Word& word) {
      ray.words.at(number) = word.bits;
      ray.defined.at(number) = word.known ? ~0u : 0;
    };
    for (size_t i = 0; i < 3; ++i) {
      put(word::kOrigin + i, origin.at(i));
      put(word::kDirection + i, direction.at(i));
    }
    put(word::kLimit, tmax);
    put(word::kPixel, known(pixel_));
    const Pointer& carried_by = pointer(o.at(10));
    if (call) {
      if (std::count(ray.defined.begin(), ray.defined.begin() + word::kPixel, 0u) != 0)
        throw UndefinedBehaviour("a ray that is not defined is traced");
      Words carried = read(carried_by);
      Call its = {ray.words, decided(get(o[1]).at(0)), decided(get(o.at(5)).at(0)), decided(get(o.at(3)).at(0)), 0};
      its.begin = as_float(tmin.bits);
      call(*this, its, carried);
      write(carried_by, carried);
      return;
    }
    uint32_t depth = 1;
    if (kernel_ != RayKernel::CastEye) depth = (input[word::kFlags] & kDepthMask) + (shadow ? 0 : 1);
    uint32_t flags = depth | (shadow ? kShadowFlag : 0), flags_defined = 0xff0000ffu;
    const Words carried = read(carried_by);
    const std::vector<uint32_t> types = leaves(carried_by.type);
    size_t next = word::kColor;
    for (size_t i = 0; i < types.size(); ++i) {
      if (is_tag(types[i])) {
        flags |= (carried.at(i).bits & 0xffff) << 8;
        if (carried[i].known) flags_defined = ~0u;
      } else {
        put(next++, carried.at(i));
      }
    }
    ray.words[word::kFlags] = flags;
    ray.defined[word::kFlags] = flags_defined;
    rays.push_back(ray);
  }

  void contribute(const shader::Line& line) {
    const Words &place = get(line.operands.at(1)), &colour = get(line.operands.at(2));
    const uint32_t x = decided(place.at(0)), y = decided(place.at(1));
    if (x >= resources_.width || y >= resources_.height) return;
    OracleContribution out;
    out.pixel = x | y << 16;
    for (size_t i = 0; i < 3; ++i) {
      out.rgb.at(i) = colour.at(i).bits;
      out.defined.at(i) = colour.at(i).known;
    }
    frame.push_back(out);
  }

  void texels(const shader::Line& line) {
    Native k(native_);
    const Int record(decided(get(line.operands.at(0)).at(0)));
    const uint32_t u = decided(get(line.operands.at(1)).at(0)), v = decided(get(line.operands[1]).at(1));
    const shader::Texel<Native> texel = line.op == Op::OpImageFetch
                                            ? shader::fetch_texel(k, record, Int(u), Int(v))
                                            : shader::sample(k, record, Float::of_bits(u), Float::of_bits(v));
    values_[line.id].words = {known(texel.x.bits), known(texel.y.bits), known(texel.z.bits), known(texel.w.bits)};
  }

  const shader::Module& module_;
  const shader::Resources& resources_;
  RayKernel kernel_;
  const std::array<uint32_t, kArguments>& arguments_;
  Memory& memory_;
  NativeThread native_;
  uint32_t pixel_ = 0;
  std::unordered_map<uint32_t, Value> values_;
  std::map<uint32_t, Words> storage_;  // of variables; a map's elements stay where they are
  std::map<uint32_t, uint32_t> ends_;  // bytes of the buffer
};

}  // namespace raypool::test
