// Variables, buffers, uniform blocks and textures of a shader.
#include <fmt/format.h>

#include <algorithm>

#include "shader/lowering.hpp"
#include "shader/texture.hpp"

namespace raypool::shader {
namespace {

/// Beyond this, choosing among the words of an array takes too many instructions.
constexpr size_t kMostChoices = 256;

}  // namespace

void Lowering::begin_variables() {
  // Which variables are ever written: what is read of the others needs no copy.
  std::map<uint32_t, uint32_t> roots;
  const auto root = [&](uint32_t id) {
    const auto found = roots.find(id);
    return found == roots.end() ? id : found->second;
  };
  for (const Block& block : module_.blocks()) {
    for (const Line& line : block.lines) {
      if (line.op == spv::Op::OpAccessChain || line.op == spv::Op::OpInBoundsAccessChain)
        roots[line.id] = root(line.operands.at(0));
      if (line.op == spv::Op::OpStore) written_.insert(root(line.operands.at(0)));
      if (line.op == spv::Op::OpExecuteCallableKHR) written_.insert(line.operands.at(1));
      // modf() and frexp() write their second result.
      if (line.op == spv::Op::OpExtInst && type_of(line.operands.back()) != 0 &&
          module_.type(type_of(line.operands.back())).kind == TypeKind::Pointer)
        written_.insert(root(line.operands.back()));
    }
  }
  const auto declare_all = [&](uint32_t id, uint32_t pointer_type, uint32_t initial) {
    const uint32_t type = module_.type(pointer_type).element;
    Value& value = variables_[id];
    value.resize(module_.scalars(type));
    if (written_.count(id) != 0 && initial == 0)
      for (uint32_t i = 0; i < value.size(); ++i) value[i] = declare(is_condition(type, i));
    if (initial != 0) keep(id, type, get(initial));
  };
  for (const auto& [id, variable] : module_.variables()) {
    const Type& pointer = module_.type(variable.type);
    switch (variable.storage) {
      case spv::StorageClass::Private:
      case spv::StorageClass::RayPayloadKHR:
      case spv::StorageClass::CallableDataKHR:
        declare_all(id, variable.type, variable.initial);
        break;
      case spv::StorageClass::Input:
        if (const auto number = module_.decorations(id).built_in) variables_[id] = built_in(*number, pointer.element);
        break;
      case spv::StorageClass::HitAttributeKHR:
        variables_[id] = hit_attribute(pointer.element);
        break;
      case spv::StorageClass::IncomingRayPayloadKHR:
        load_payload(id, variable);
        break;
      case spv::StorageClass::IncomingCallableDataKHR: {
        // One that takes more than it is given reads nothing defined.
        Value data = callable_data_;
        data.resize(module_.scalars(pointer.element));
        keep(id, pointer.element, data);
        break;
      }
      default:
        break;
    }
  }
  for (const auto& [id, line] : module_.locals())
    declare_all(id, line.type, line.operands.size() > 1 ? line.operands[1] : 0);
}

/// A variable that begins with this value.
void Lowering::keep(uint32_t id, uint32_t type, const Value& first) {
  Value& value = variables_[id];
  value = first;
  if (written_.count(id) == 0) return;
  for (uint32_t i = 0; i < value.size(); ++i) {
    value[i] = declare(is_condition(type, i));
    assign(value[i], first[i]);
    way_.known[{id, i}] = first[i];
  }
}

const Value& Lowering::variable(uint32_t id) {
  const auto found = variables_.find(id);
  if (found == variables_.end())
    fail(fmt::format("variable '{}' is of a kind that is not supported here", module_.name_of(id)));
  return found->second;
}

/// Of a uniform block, the push constants or the shader record; null: it is none of these, or has no content.
const std::vector<Word>* Lowering::known_words(const Variable& variable, const Place& place) const {
  const auto found = [](const auto& all, const auto& key) {
    const auto its = all.find(key);
    return its == all.end() ? nullptr : &its->second;
  };
  switch (variable.storage) {
    case spv::StorageClass::Uniform:
    case spv::StorageClass::StorageBuffer:
      return found(resources_.blocks, place);
    case spv::StorageClass::PushConstant:
      return &resources_.push_constants;
    case spv::StorageClass::ShaderRecordBufferKHR:
      return found(resources_.records, RecordPlace{record_stage(module_.stage()), module_.number()});
    default:
      return nullptr;
  }
}

Pointer Lowering::global(uint32_t id, const Variable& variable) {
  Pointer pointer;
  pointer.type = module_.type(variable.type).element;
  pointer.variable = id;
  const Decorations& decorations = module_.decorations(id);
  const Place place = {decorations.set.value_or(0), decorations.binding.value_or(0)};
  const auto missing = [&](const char* what) {
    fail(fmt::format("{} '{}' (set {}, binding {}) has no content: name it in shaders.json", what, module_.name_of(id),
                     place.first, place.second));
  };
  pointer.words = known_words(variable, place);
  if (pointer.words != nullptr) {
    pointer.to = Pointer::To::Words;
    return pointer;
  }
  switch (variable.storage) {
    case spv::StorageClass::Uniform:
    case spv::StorageClass::StorageBuffer: {
      const auto buffer = resources_.buffers.find(place);
      if (buffer == resources_.buffers.end())
        missing(variable.storage == spv::StorageClass::Uniform ? "block" : "buffer");
      pointer.to = Pointer::To::Memory;
      pointer.offset = buffer->second.address;
      pointer.size = buffer->second.bytes;
      return pointer;
    }
    case spv::StorageClass::ShaderRecordBufferKHR:
      fail(fmt::format("shader record '{}' has no content: give it a record in shaders.json", module_.name_of(id)));
    case spv::StorageClass::UniformConstant: {
      const Type& its = module_.type(pointer.type);
      uint32_t element = pointer.type;
      if (its.kind == TypeKind::Array || its.kind == TypeKind::RuntimeArray) element = its.element;
      switch (module_.type(element).kind) {
        case TypeKind::SampledImage: {
          if (!module_.type(module_.type(element).element).is_2d)
            fail(fmt::format("sampler '{}' is not a sampler2D, and the scene has no other textures",
                             module_.name_of(id)));
          const auto textures = resources_.textures.find(place);
          if (textures == resources_.textures.end()) missing("sampler");
          pointer.to = Pointer::To::Textures;
          pointer.offset = textures->second.address;
          return pointer;
        }
        case TypeKind::Image:
          pointer.to = resources_.unseen.count(place) == 0 ? Pointer::To::Picture : Pointer::To::Nothing;
          return pointer;
        case TypeKind::AccelerationStructure:
          pointer.to = Pointer::To::Tree;
          return pointer;
        default:
          fail(fmt::format("'{}' is not a sampler2D, image2D or accelerationStructureEXT", module_.name_of(id)));
      }
    }
    default:
      pointer.to = Pointer::To::Variable;
      return pointer;
  }
}

Pointer Lowering::pointer_of(uint32_t id) {
  const auto found = pointers_.find(id);
  if (found != pointers_.end()) return found->second;
  const auto variable = module_.variables().find(id);
  if (variable != module_.variables().end()) return global(id, variable->second);
  const auto local = module_.locals().find(id);
  if (local == module_.locals().end())
    fail("a pointer that is chosen when the shader runs is not supported: choose between values");
  Pointer pointer;
  pointer.type = module_.type(local->second.type).element;
  pointer.variable = id;
  return pointer;
}

void Lowering::step_into(Pointer& pointer, uint32_t index_id) {
  const Type& whole = module_.type(pointer.type);
  const Scalar index = get_scalar(index_id);
  const bool in_memory = pointer.to == Pointer::To::Memory || pointer.to == Pointer::To::Words;
  if (whole.kind == TypeKind::Struct) {
    if (!index.is_constant()) fail("a member of a struct is chosen by a value: use an array");
    const uint32_t member = index.bits;
    if (in_memory) {
      const MemberLayout layout = module_.layout(pointer.type, member);
      pointer.offset += layout.offset;
      pointer.column_stride = layout.row_major ? 4 : layout.matrix_stride;
      pointer.component_stride = layout.row_major ? layout.matrix_stride : 4;
    } else {
      for (uint32_t m = 0; m < member; ++m) pointer.offset += module_.scalars(whole.members.at(m));
    }
    pointer.type = whole.members.at(member);
    return;
  }
  uint32_t stride = 0;
  if (pointer.to == Pointer::To::Textures)
    stride = kTextureBytes;
  else if (!in_memory)
    stride = module_.scalars(whole.element);
  else if (whole.kind == TypeKind::Matrix)
    stride = pointer.column_stride;
  else if (whole.kind == TypeKind::Vector)
    stride = pointer.component_stride;
  else
    stride = whole.stride;
  pointer.type = whole.element;
  if (index.is_constant()) {
    pointer.offset += index.bits * stride;
  } else {
    pointer.dynamic.push_back({index, stride, whole.count});
  }
}

void Lowering::access(const Line& line) {
  Pointer pointer = pointer_of(line.operands.at(0));
  for (size_t i = 1; i < line.operands.size(); ++i) step_into(pointer, line.operands[i]);
  pointers_[line.id] = pointer;
}

/// The line's pointer leads to this byte of memory.
void Lowering::set_address(const Line& line, const Scalar& address) {
  Pointer pointer;
  pointer.to = Pointer::To::Memory;
  pointer.type = module_.type(line.type).element;
  pointer.base = kept(line.id, 0, address);
  pointers_[line.id] = pointer;
}

void Lowering::load(const Line& line) {
  const Pointer pointer = pointer_of(line.operands.at(0));
  if (pointer.to == Pointer::To::Tree) return;
  if (pointer.to == Pointer::To::Picture || pointer.to == Pointer::To::Nothing) {
    images_[line.id] = {Scalar{}, true};
    if (pointer.to == Pointer::To::Nothing) unseen_.insert(line.id);
    return;
  }
  if (pointer.to == Pointer::To::Textures) {
    Scalar record = Scalar::constant(pointer.offset);
    for (const DynamicIndex& part : pointer.dynamic)
      record = binary(Opcode::Iadd, scaled(part.index, part.stride), record);
    images_[line.id] = {kept(line.id, 0, record), false};
    return;
  }
  if (module_.type(line.type).kind == TypeKind::Pointer) {
    // A buffer's address, kept in a block or a buffer: 64 bits there, of which the machine uses the low word.
    Scalar low;
    if (pointer.to == Pointer::To::Memory) {
      const auto [base, offset] = address(pointer);
      if (path_ && path_->shares_buffers) forget(base, offset, offset);
      low = of(k_.load_int(as_int(base), static_cast<int>(offset)));
    } else if (pointer.to == Pointer::To::Words && pointer.dynamic.empty()) {
      low = word_scalar(pointer.words->at(pointer.offset / 4));
    } else {
      fail("an address that is kept in a variable is not supported: keep its uvec2");
    }
    set_address(line, low);
    return;
  }
  set(line, load_from(pointer));
}

void Lowering::store(const Line& line) {
  const Pointer pointer = pointer_of(line.operands.at(0));
  store_to(pointer, get(line.operands.at(1)));
}

std::pair<Scalar, uint32_t> Lowering::address(const Pointer& pointer) {
  std::optional<Scalar> base = pointer.base;
  for (const DynamicIndex& part : pointer.dynamic) {
    const Scalar bytes = scaled(part.index, part.stride);
    base = base ? binary(Opcode::Iadd, *base, bytes) : bytes;
  }
  return {base.value_or(Scalar::constant(0)), pointer.offset};
}

template <typename Leaf>
void Lowering::for_each_scalar(uint32_t type, uint32_t offset, uint32_t component_stride, uint32_t column_stride,
                               const Leaf& leaf) {
  const Type& its = module_.type(type);
  switch (its.kind) {
    case TypeKind::Int:
    case TypeKind::Float:
      if (module_.is_wide(type)) {
        leaf(offset);
        leaf(offset + 4);
        return;
      }
      if (its.bits != 32) fail("memory holds numbers of 32 bits: pack smaller ones into a uint");
      leaf(offset);
      return;
    case TypeKind::Vector:
      for (uint32_t i = 0; i < its.count; ++i)
        for_each_scalar(its.element, offset + i * component_stride, component_stride, column_stride, leaf);
      return;
    case TypeKind::Matrix:
      for (uint32_t i = 0; i < its.count; ++i)
        for_each_scalar(its.element, offset + i * column_stride, component_stride, column_stride, leaf);
      return;
    case TypeKind::Array:
      for (uint32_t i = 0; i < its.count; ++i)
        for_each_scalar(its.element, offset + i * its.stride, component_stride, column_stride, leaf);
      return;
    case TypeKind::Struct:
      for (uint32_t m = 0; m < its.members.size(); ++m) {
        const MemberLayout layout = module_.layout(type, m);
        for_each_scalar(its.members[m], offset + layout.offset, layout.row_major ? layout.matrix_stride : 4,
                        layout.row_major ? 4 : layout.matrix_stride, leaf);
      }
      return;
    default:
      fail("a whole buffer without a size cannot be copied: read its elements");
  }
}

Scalar Lowering::word_scalar(const Word& word) {
  if (!word.argument) return Scalar::constant(word.bits);
  return of(k_.int_argument(static_cast<int>(*word.argument)));
}

Value Lowering::read_words(const Pointer& pointer) {
  const auto at = [&](uint32_t offset) {
    Value value;
    for_each_scalar(pointer.type, offset, pointer.component_stride, pointer.column_stride, [&](uint32_t byte) {
      value.push_back(byte / 4 < pointer.words->size() ? word_scalar((*pointer.words)[byte / 4]) : Scalar{});
    });
    return value;
  };
  if (pointer.dynamic.empty()) return at(pointer.offset);
  // One after the other is chosen.
  Pointer rest = pointer;
  const DynamicIndex part = rest.dynamic.back();
  rest.dynamic.pop_back();
  if (part.count == 0 || part.count * module_.scalars(pointer.type) > kMostChoices) {
    fail(fmt::format("an array of {} elements in a uniform block is indexed by a value: put it into a buffer",
                     part.count));
  }
  Value value = read_words(rest);
  for (uint32_t n = 1; n < part.count; ++n) {
    rest.offset += part.stride;
    const Value other = read_words(rest);
    const Scalar chosen = compare(Opcode::Ieq, part.index, Scalar::constant(n));
    for (size_t i = 0; i < value.size(); ++i) value[i] = select(chosen, other[i], value[i]);
  }
  return value;
}

Value Lowering::load_from(const Pointer& pointer) {
  switch (pointer.to) {
    case Pointer::To::Words:
      return read_words(pointer);
    case Pointer::To::Memory: {
      const auto [base, offset] = address(pointer);
      const RecordedInt from = as_int(base);
      Value value;
      if (path_ && path_->shares_buffers) {
        uint32_t last = offset;
        for_each_scalar(pointer.type, offset, pointer.component_stride, pointer.column_stride,
                        [&](uint32_t byte) { last = std::max(last, byte); });
        forget(base, offset, last);
      }
      for_each_scalar(pointer.type, offset, pointer.component_stride, pointer.column_stride,
                      [&](uint32_t byte) { value.push_back(of(k_.load_int(from, static_cast<int>(byte)))); });
      return value;
    }
    case Pointer::To::Variable: {
      const Value& whole = variable(pointer.variable);
      const uint32_t size = module_.scalars(pointer.type);
      if (!pointer.dynamic.empty()) return chosen_part(whole, pointer, pointer.dynamic.size(), pointer.offset, size);
      Value value(whole.begin() + pointer.offset, whole.begin() + pointer.offset + size);
      if (written_.count(pointer.variable) == 0) return value;
      for (size_t i = 0; i < size; ++i) {
        const auto known = way_.known.find({pointer.variable, pointer.offset + i});
        value[i] = known != way_.known.end() ? known->second : copy(value[i]);
      }
      return value;
    }
    default:
      fail("this cannot be read as a value");
  }
}

/// Of a variable's scalars those at an index that is known only when the shader runs, of the first `depth` indices.
Value Lowering::chosen_part(const Value& whole, const Pointer& pointer, size_t depth, uint32_t offset, uint32_t size) {
  if (depth == 0) {
    if (offset + size > whole.size()) return Value(size);
    return {whole.begin() + offset, whole.begin() + offset + size};
  }
  const DynamicIndex& part = pointer.dynamic[depth - 1];
  if (part.count * size > kMostChoices) {
    fail(
        fmt::format("an array of {} elements in a variable is indexed by a value, which takes an instruction for each "
                    "element: put it into a buffer",
                    part.count));
  }
  Value value = chosen_part(whole, pointer, depth - 1, offset, size);
  bool copied = false;
  for (uint32_t n = 1; n < part.count; ++n) {
    const Value other = chosen_part(whole, pointer, depth - 1, offset + n * part.stride, size);
    const Scalar chosen = compare(Opcode::Ieq, part.index, Scalar::constant(n));
    for (size_t i = 0; i < value.size(); ++i) value[i] = select(chosen, other[i], value[i]);
    copied = true;
  }
  if (!copied && written_.count(pointer.variable) != 0)
    for (Scalar& scalar : value) scalar = copy(scalar);
  return value;
}

void Lowering::store_chosen(Value& whole, const Pointer& pointer, size_t depth, uint32_t offset, const Value& value) {
  if (depth == 0) {
    for (size_t i = 0; i < value.size(); ++i) assign(whole.at(offset + i), value[i]);
    return;
  }
  const DynamicIndex& part = pointer.dynamic[depth - 1];
  if (part.count * value.size() > kMostChoices) {
    fail(
        fmt::format("an array of {} elements in a variable is written at an index that is a value, which takes "
                    "instructions for each element: make it smaller",
                    part.count));
  }
  for (uint32_t n = 0; n < part.count; ++n) {
    under(compare(Opcode::Ieq, part.index, Scalar::constant(n)),
          [&] { store_chosen(whole, pointer, depth - 1, offset + n * part.stride, value); });
  }
}

void Lowering::store_to(const Pointer& pointer, const Value& value) {
  switch (pointer.to) {
    case Pointer::To::Memory: {
      const auto [base, offset] = address(pointer);
      const RecordedInt to = as_int(base);
      size_t next = 0;
      for_each_scalar(pointer.type, offset, pointer.component_stride, pointer.column_stride, [&](uint32_t byte) {
        const Scalar& scalar = value.at(next++);
        if (!scalar.is_undefined()) k_.store(to, static_cast<int>(byte), as_int(scalar));
      });
      return;
    }
    case Pointer::To::Variable: {
      variable(pointer.variable);  // there is one
      store_chosen(variables_.at(pointer.variable), pointer, pointer.dynamic.size(), pointer.offset, value);
      if (pointer.dynamic.empty()) {
        for (size_t i = 0; i < value.size(); ++i) way_.known[{pointer.variable, pointer.offset + i}] = value[i];
      } else {
        for (size_t i = 0; i < variable(pointer.variable).size(); ++i) way_.known.erase({pointer.variable, i});
      }
      return;
    }
    case Pointer::To::Words:
      fail("a uniform block or shader record cannot be written: use a buffer");
    default:
      fail("this cannot be written as a value");
  }
}

void Lowering::sample(const Line& line) {
  const auto image = images_.find(line.operands.at(0));
  if (image == images_.end() || image->second.second) fail("only a sampler2D can be sampled");
  const Value place = get(line.operands.at(1));
  const RecordedInt record = as_int(image->second.first);
  const RecordedFloat u = as_float(place.at(0)), v = as_float(place.at(1));
  const auto texel = shader::sample(k_, record, u, v);
  set(line, {of(texel.x), of(texel.y), of(texel.z), of(texel.w)});
}

void Lowering::fetch(const Line& line) {
  const auto image = images_.find(line.operands.at(0));
  if (image == images_.end() || image->second.second) fail("only a texel of a sampler2D can be fetched");
  const Value place = get(line.operands.at(1));
  const RecordedInt record = as_int(image->second.first), x = as_int(place.at(0)), y = as_int(place.at(1));
  const auto texel = fetch_texel(k_, record, x, y);
  set(line, {of(texel.x), of(texel.y), of(texel.z), of(texel.w)});
}

void Lowering::query_size(const Line& line) {
  const auto image = images_.find(line.operands.at(0));
  if (image == images_.end()) fail("the size of this cannot be asked for");
  if (image->second.second) {
    set(line, {Scalar::constant(resources_.width), Scalar::constant(resources_.height)});
    return;
  }
  const RecordedInt record = as_int(image->second.first);
  set(line, {of(k_.load_int(record, 4)), of(k_.load_int(record, 8))});
}

}  // namespace raypool::shader
