#include "shader/module.hpp"

#include <fmt/format.h>

#include <cstring>
#include <mutex>
#include <set>

#include "isa/input_error.hpp"

namespace raypool::shader {
namespace {

constexpr uint32_t kMagic = 0x07230203;

/// Text that ends with a zero, from the word `at` on, which moves behind it.
std::string text_at(const std::vector<uint32_t>& words, size_t& at) {
  std::string text;
  for (; at < words.size(); ++at) {
    for (int byte = 0; byte < 4; ++byte) {
      const char c = static_cast<char>(words[at] >> (8 * byte) & 0xff);
      if (c == 0) {
        ++at;
        return text;
      }
      text += c;
    }
  }
  return text;
}

const std::string kNoName;
const Decorations kUndecorated;

bool is_constant(spv::Op op) {
  switch (op) {
    case spv::Op::OpConstant:
    case spv::Op::OpConstantTrue:
    case spv::Op::OpConstantFalse:
    case spv::Op::OpConstantComposite:
    case spv::Op::OpConstantNull:
    case spv::Op::OpSpecConstant:
    case spv::Op::OpSpecConstantTrue:
    case spv::Op::OpSpecConstantFalse:
    case spv::Op::OpSpecConstantComposite:
    case spv::Op::OpSpecConstantOp:
    case spv::Op::OpUndef:
      return true;
    default:
      return false;
  }
}

bool ends_block(spv::Op op) {
  switch (op) {
    case spv::Op::OpBranch:
    case spv::Op::OpBranchConditional:
    case spv::Op::OpSwitch:
    case spv::Op::OpReturn:
    case spv::Op::OpReturnValue:
    case spv::Op::OpKill:
    case spv::Op::OpUnreachable:
    case spv::Op::OpIgnoreIntersectionKHR:
    case spv::Op::OpTerminateRayKHR:
      return true;
    default:
      return false;
  }
}

/// Debug text and hints, which change nothing.
bool says_nothing(spv::Op op) {
  switch (op) {
    case spv::Op::OpNop:
    case spv::Op::OpSource:
    case spv::Op::OpSourceExtension:
    case spv::Op::OpSourceContinued:
    case spv::Op::OpMemoryModel:
    case spv::Op::OpExecutionMode:
    case spv::Op::OpModuleProcessed:
    case spv::Op::OpTypeForwardPointer:
    case spv::Op::OpFunctionParameter:
    case spv::Op::OpExtension:
      return true;
    default:
      return false;
  }
}

}  // namespace

RecordStage record_stage(spv::ExecutionModel stage) {
  switch (stage) {
    case spv::ExecutionModel::RayGenerationKHR:
      return RecordStage::RayGeneration;
    case spv::ExecutionModel::MissKHR:
      return RecordStage::Miss;
    case spv::ExecutionModel::CallableKHR:
      return RecordStage::Callable;
    default:
      return RecordStage::HitGroup;
  }
}

const char* lasting(const std::string& name) {
  static std::mutex mutex;
  static std::set<std::string> names;
  const std::lock_guard lock(mutex);
  return names.insert(name).first->c_str();
}

Module::Module(const std::vector<uint32_t>& words, const std::string& name,
               const std::map<uint32_t, uint32_t>& specialization, uint32_t number)
    : name_(name), file_{lasting(name), 0}, number_(number) {
  read(words, specialization);
  count_uses();
}

void Module::fail(const kernel::Location& where, const std::string& what) const {
  if (where.line == 0) throw InputError(fmt::format("{}: {}", name_, what));
  throw InputError(fmt::format("{}:{}: {}", where.file, where.line, what));
}

bool Module::read_name(spv::Op op, const std::vector<uint32_t>& operands) {
  size_t behind = 1;
  switch (op) {
    case spv::Op::OpName:
      names_[operands.at(0)] = text_at(operands, behind);
      return true;
    case spv::Op::OpMemberName:
      behind = 2;
      members_[{operands.at(0), operands.at(1)}].name = text_at(operands, behind);
      return true;
    case spv::Op::OpExtInstImport:
      if (text_at(operands, behind) == "GLSL.std.450") glsl_set_ = operands.at(0);
      return true;
    case spv::Op::OpEntryPoint:
      if (entry_ != 0) fail({}, "it has two entry points: give each shader a file of its own");
      stage_ = static_cast<spv::ExecutionModel>(operands.at(0));
      entry_ = operands.at(1);
      return true;
    case spv::Op::OpCapability:
      switch (static_cast<spv::Capability>(operands.at(0))) {
        case spv::Capability::Float64:
          fail({}, "it uses double, which the machine does not have: use float");
        case spv::Capability::Float16:
          fail({}, "it uses 16-bit floats, which the machine does not have: use float");
        default:
          return true;
      }
    case spv::Op::OpDecorate:
      decorate(operands.at(0), {operands.begin() + 1, operands.end()});
      return true;
    case spv::Op::OpMemberDecorate:
      decorate_member(operands);
      return true;
    default:
      return false;
  }
}

Line Module::line_of(spv::Op op, const std::vector<uint32_t>& operands, const kernel::Location& where) {
  bool has_result = false, has_type = false;
  spv::HasResultAndType(op, &has_result, &has_type);
  Line line;
  line.op = op;
  line.where = where;
  size_t first = 0;
  if (has_type) line.type = operands.at(first++);
  if (has_result) line.id = operands.at(first++);
  line.operands.assign(operands.begin() + static_cast<std::ptrdiff_t>(first), operands.end());
  if (line.type != 0) types_of_values_[line.id] = line.type;
  return line;
}

void Module::read_global(Line line, const std::map<uint32_t, uint32_t>& specialization) {
  if (line.op == spv::Op::OpVariable) {
    variables_[line.id] = {line.type, static_cast<spv::StorageClass>(line.operands.at(0)),
                           line.operands.size() > 1 ? line.operands[1] : 0};
  } else if (is_constant(line.op)) {
    read_constant(std::move(line), specialization);
  } else {
    fail(line.where, fmt::format("SPIR-V instruction {} is not supported here: write the shader without it",
                                 static_cast<uint32_t>(line.op)));
  }
}

void Module::read(const std::vector<uint32_t>& words, const std::map<uint32_t, uint32_t>& specialization) {
  if (words.size() < 5 || words[0] != kMagic)
    fail({}, "this is not SPIR-V of this machine's byte order: compile it with glslangValidator -V");
  Block* open = nullptr;
  kernel::Location where = file_;
  bool in_entry = false;
  uint32_t functions = 0;
  for (size_t at = 5; at < words.size();) {
    const size_t length = words[at] >> 16;
    const auto op = static_cast<spv::Op>(words[at] & 0xffff);
    if (length == 0 || at + length > words.size()) fail({}, "the SPIR-V ends within an instruction: make it again");
    std::vector<uint32_t> operands(words.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                                   words.begin() + static_cast<std::ptrdiff_t>(at + length));
    at += length;
    size_t behind = 1;
    switch (op) {
      case spv::Op::OpString:
        files_[operands.at(0)] = lasting(text_at(operands, behind));
        continue;
      case spv::Op::OpLine: {
        const auto file = files_.find(operands.at(0));
        where = {file == files_.end() || *file->second == 0 ? file_.file : file->second,
                 static_cast<int>(operands.at(1))};
        continue;
      }
      case spv::Op::OpNoLine:
        where = file_;
        continue;
      case spv::Op::OpFunction:
        in_entry = operands.at(1) == entry_;
        ++functions;
        continue;
      case spv::Op::OpFunctionEnd:
        in_entry = false;
        open = nullptr;
        continue;
      default:
        break;
    }
    if (read_name(op, operands) || says_nothing(op)) continue;
    if (op >= spv::Op::OpTypeVoid && op <= spv::Op::OpTypeFunction) {
      read_type(op, operands);
      continue;
    }
    if (op == spv::Op::OpTypeRayQueryKHR)
      fail(where,
           "rayQueryEXT is not supported: trace with traceRayEXT, which the traverser does for a thread of its own");
    if (op == spv::Op::OpTypeAccelerationStructureKHR) {
      types_[operands.at(0)].kind = TypeKind::AccelerationStructure;
      continue;
    }
    Line line = line_of(op, operands, where);
    if (functions == 0) {
      read_global(std::move(line), specialization);
    } else if (in_entry) {
      read_line(std::move(line), open);
    }
  }
  if (blocks_.empty()) fail({}, "it has no main(): add one");
  for (size_t i = 0; i < blocks_.size(); ++i) block_at_[blocks_[i].label] = i;
}

// NOLINTNEXTLINE(readability-function-size): a list of types
void Module::read_type(spv::Op op, const std::vector<uint32_t>& operands) {
  Type type;
  const uint32_t id = operands.at(0);
  switch (op) {
    case spv::Op::OpTypeVoid:
      break;
    case spv::Op::OpTypeBool:
      type.kind = TypeKind::Bool;
      break;
    case spv::Op::OpTypeInt:
      type.kind = TypeKind::Int;
      type.bits = operands.at(1);
      type.is_signed = operands.at(2) != 0;
      break;
    case spv::Op::OpTypeFloat:
      type.kind = TypeKind::Float;
      type.bits = operands.at(1);
      break;
    case spv::Op::OpTypeVector:
    case spv::Op::OpTypeMatrix:
      type.kind = op == spv::Op::OpTypeVector ? TypeKind::Vector : TypeKind::Matrix;
      type.element = operands.at(1);
      type.count = operands.at(2);
      break;
    case spv::Op::OpTypeArray: {
      type.kind = TypeKind::Array;
      type.element = operands.at(1);
      type.count = constant(operands.at(2)).value_or(0);
      break;
    }
    case spv::Op::OpTypeRuntimeArray:
      type.kind = TypeKind::RuntimeArray;
      type.element = operands.at(1);
      break;
    case spv::Op::OpTypeStruct:
      type.kind = TypeKind::Struct;
      type.members.assign(operands.begin() + 1, operands.end());
      break;
    case spv::Op::OpTypePointer:
      type.kind = TypeKind::Pointer;
      type.storage = static_cast<spv::StorageClass>(operands.at(1));
      type.element = operands.at(2);
      break;
    case spv::Op::OpTypeImage:
      type.kind = TypeKind::Image;
      type.element = operands.at(1);
      type.is_2d = operands.at(2) == static_cast<uint32_t>(spv::Dim::Dim2D) && operands.at(4) == 0;
      break;
    case spv::Op::OpTypeSampledImage:
      type.kind = TypeKind::SampledImage;
      type.element = operands.at(1);
      break;
    case spv::Op::OpTypeFunction:
      type.kind = TypeKind::Function;
      break;
    default:
      fail({}, fmt::format("SPIR-V type {} is not supported: use floats, integers, vectors, matrices, arrays, structs "
                           "and sampler2D",
                           static_cast<uint32_t>(op)));
  }
  const auto stride = strides_.find(id);
  if (stride != strides_.end()) type.stride = stride->second;
  types_[id] = std::move(type);
}

void Module::decorate(uint32_t id, const std::vector<uint32_t>& operands) {
  Decorations& known = decorations_[id];
  const auto value = [&] { return operands.at(1); };
  switch (static_cast<spv::Decoration>(operands.at(0))) {
    case spv::Decoration::DescriptorSet:
      known.set = value();
      break;
    case spv::Decoration::Binding:
      known.binding = value();
      break;
    case spv::Decoration::BuiltIn:
      known.built_in = value();
      break;
    case spv::Decoration::SpecId:
      known.constant_id = value();
      break;
    case spv::Decoration::NoContraction:
      known.no_contraction = true;
      break;
    case spv::Decoration::Block:
      known.block = true;
      break;
    case spv::Decoration::ArrayStride:
      strides_[id] = value();
      break;
    default:
      break;
  }
}

void Module::decorate_member(const std::vector<uint32_t>& operands) {
  MemberLayout& member = members_[{operands.at(0), operands.at(1)}];
  switch (static_cast<spv::Decoration>(operands.at(2))) {
    case spv::Decoration::Offset:
      member.offset = operands.at(3);
      break;
    case spv::Decoration::MatrixStride:
      member.matrix_stride = operands.at(3);
      break;
    case spv::Decoration::RowMajor:
      member.row_major = true;
      break;
    default:
      break;
  }
}

void Module::read_constant(Line line, const std::map<uint32_t, uint32_t>& specialization) {
  const auto chosen = [&]() -> std::optional<uint32_t> {
    const auto id = decorations(line.id).constant_id;
    const auto found = id ? specialization.find(*id) : specialization.end();
    if (found == specialization.end()) return std::nullopt;
    return found->second;
  };
  const Type& its = type(line.type);
  switch (line.op) {
    case spv::Op::OpConstant:
      if (!is_wide(line.type)) scalars_[line.id] = line.operands.at(0);
      break;
    case spv::Op::OpSpecConstant:
      if (!is_wide(line.type)) scalars_[line.id] = chosen().value_or(line.operands.at(0));
      break;
    case spv::Op::OpConstantTrue:
    case spv::Op::OpConstantFalse:
      scalars_[line.id] = line.op == spv::Op::OpConstantTrue ? 1 : 0;
      break;
    case spv::Op::OpSpecConstantTrue:
    case spv::Op::OpSpecConstantFalse:
      scalars_[line.id] = chosen().value_or(line.op == spv::Op::OpSpecConstantTrue ? 1 : 0) != 0 ? 1 : 0;
      break;
    case spv::Op::OpConstantNull:
      if (its.kind == TypeKind::Bool || its.kind == TypeKind::Int || its.kind == TypeKind::Float)
        if (!is_wide(line.type)) scalars_[line.id] = 0;
      break;
    case spv::Op::OpSpecConstantOp: {
      const std::optional<uint32_t> bits = fold(line);
      if (!bits) fail(line.where, "this expression of specialization constants is not supported: compute it in main()");
      scalars_[line.id] = *bits;
      break;
    }
    default:
      break;
  }
  constants_.push_back(std::move(line));
}

/// An expression of specialization constants: of integers and conditions.
// NOLINTNEXTLINE(readability-function-size): a list of instructions
std::optional<uint32_t> Module::fold(const Line& line) const {
  std::vector<uint32_t> values;
  for (size_t i = 1; i < line.operands.size(); ++i) {
    const auto value = constant(line.operands[i]);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  const auto a = values.empty() ? 0 : values[0], b = values.size() < 2 ? 0 : values[1];
  const auto sa = static_cast<int32_t>(a), sb = static_cast<int32_t>(b);
  switch (static_cast<spv::Op>(line.operands.at(0))) {
    case spv::Op::OpIAdd:
      return a + b;
    case spv::Op::OpISub:
      return a - b;
    case spv::Op::OpIMul:
      return a * b;
    case spv::Op::OpSNegate:
      return 0 - a;
    case spv::Op::OpUDiv:
      return b == 0 ? std::nullopt : std::optional(a / b);
    case spv::Op::OpSDiv:
      return b == 0 || b == 0xffffffffu ? std::nullopt : std::optional(static_cast<uint32_t>(sa / sb));
    case spv::Op::OpUMod:
      return b == 0 ? std::nullopt : std::optional(a % b);
    case spv::Op::OpShiftLeftLogical:
      return b > 31 ? 0 : a << b;
    case spv::Op::OpShiftRightLogical:
      return b > 31 ? 0 : a >> b;
    case spv::Op::OpBitwiseAnd:
      return a & b;
    case spv::Op::OpBitwiseOr:
      return a | b;
    case spv::Op::OpBitwiseXor:
      return a ^ b;
    case spv::Op::OpNot:
      return ~a;
    case spv::Op::OpIEqual:
    case spv::Op::OpLogicalEqual:
      return a == b;
    case spv::Op::OpINotEqual:
    case spv::Op::OpLogicalNotEqual:
      return a != b;
    case spv::Op::OpSLessThan:
      return sa < sb;
    case spv::Op::OpSLessThanEqual:
      return sa <= sb;
    case spv::Op::OpSGreaterThan:
      return sa > sb;
    case spv::Op::OpSGreaterThanEqual:
      return sa >= sb;
    case spv::Op::OpULessThan:
      return a < b;
    case spv::Op::OpULessThanEqual:
      return a <= b;
    case spv::Op::OpUGreaterThan:
      return a > b;
    case spv::Op::OpUGreaterThanEqual:
      return a >= b;
    case spv::Op::OpLogicalAnd:
      return a & b;
    case spv::Op::OpLogicalOr:
      return a | b;
    case spv::Op::OpLogicalNot:
      return a ^ 1;
    case spv::Op::OpSelect:
      return values.size() < 3 ? std::nullopt : std::optional(a != 0 ? b : values[2]);
    case spv::Op::OpBitcast:
    case spv::Op::OpUConvert:
    case spv::Op::OpSConvert:
      return a;
    default:
      return std::nullopt;
  }
}

void Module::read_line(Line line, Block*& open) {
  if (line.op == spv::Op::OpLabel) {
    blocks_.emplace_back();
    open = &blocks_.back();
    open->label = line.id;
    return;
  }
  if (open == nullptr) fail(line.where, "the SPIR-V has an instruction outside of a block: make it again");
  if (line.op == spv::Op::OpVariable) {
    locals_[line.id] = line;
  } else if (line.op == spv::Op::OpPhi) {
    open->phis.push_back(std::move(line));
  } else if (line.op == spv::Op::OpSelectionMerge) {
    open->merge = line.operands.at(0);
  } else if (line.op == spv::Op::OpLoopMerge) {
    open->merge = line.operands.at(0);
    open->continues = line.operands.at(1);
  } else if (ends_block(line.op)) {
    open->end = std::move(line);
    open = nullptr;
  } else {
    open->lines.push_back(std::move(line));
  }
}

/// Operands that are no ids are counted for some id as well, which is then looked upon as used more often than it is.
void Module::count_uses() {
  for (const Block& block : blocks_) {
    for (const auto* lines : {&block.phis, &block.lines})
      for (const Line& line : *lines)
        for (const uint32_t used : line.operands) ++uses_[used];
    for (const uint32_t used : block.end.operands) ++uses_[used];
  }
}

const Type& Module::type(uint32_t id) const {
  const auto found = types_.find(id);
  if (found == types_.end()) fail({}, "the SPIR-V names a type that it does not have: make it again");
  return found->second;
}

const MemberLayout& Module::layout(uint32_t struct_type, uint32_t member) const {
  static const MemberLayout none;
  const auto found = members_.find({struct_type, member});
  return found == members_.end() ? none : found->second;
}

const Decorations& Module::decorations(uint32_t id) const {
  const auto found = decorations_.find(id);
  return found == decorations_.end() ? kUndecorated : found->second;
}

const std::string& Module::name_of(uint32_t id) const {
  const auto found = names_.find(id);
  return found == names_.end() ? kNoName : found->second;
}

std::optional<uint32_t> Module::constant(uint32_t id) const {
  const auto found = scalars_.find(id);
  if (found == scalars_.end()) return std::nullopt;
  return found->second;
}

const Block& Module::block(uint32_t label) const {
  const auto found = block_at_.find(label);
  if (found == block_at_.end()) fail({}, "the SPIR-V branches to a block that it does not have: make it again");
  return blocks_[found->second];
}

uint32_t Module::type_of(uint32_t id) const {
  const auto found = types_of_values_.find(id);
  return found == types_of_values_.end() ? 0 : found->second;
}

uint32_t Module::uses(uint32_t id) const {
  const auto found = uses_.find(id);
  return found == uses_.end() ? 0 : found->second;
}

bool Module::is_wide(uint32_t id) const {
  constexpr uint32_t kBits = 64;
  return type(id).kind == TypeKind::Int && type(id).bits == kBits;
}

uint32_t Module::scalars(uint32_t id) const {
  const Type& its = type(id);
  switch (its.kind) {
    case TypeKind::Int:
      return is_wide(id) ? 2 : 1;
    case TypeKind::Bool:
    case TypeKind::Float:
      return 1;
    case TypeKind::Vector:
    case TypeKind::Matrix:
    case TypeKind::Array:
      return its.count * scalars(its.element);
    case TypeKind::Struct: {
      uint32_t sum = 0;
      for (const uint32_t member : its.members) sum += scalars(member);
      return sum;
    }
    default:
      return 0;
  }
}

}  // namespace raypool::shader
