// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// One shader as SPIR-V: its words, read into types, constants, variables and the blocks of its only function.
#pragma once

#define SPV_ENABLE_UTILITY_CODE
#include <cstdint>
#include <map>
#include <optional>
#include <spirv/unified1/spirv.hpp11>
#include <string>
#include <unordered_map>
#include <vector>

#include "kernel/intermediate.hpp"
#include "shader/resources.hpp"

namespace raypool::shader {

enum class TypeKind : uint8_t {
  Void,
  Bool,
  Int,
  Float,
  Vector,
  Matrix,
  Array,
  RuntimeArray,
  Struct,
  Pointer,
  Image,
  SampledImage,
  AccelerationStructure,
  Function,
};

struct Type {
  TypeKind kind = TypeKind::Void;
  uint32_t bits = 32;      ///< of a number
  bool is_signed = false;  ///< of an integer
  uint32_t element = 0;    ///< of a vector, matrix (a column) or array; of what a pointer points to
  uint32_t count = 0;      ///< elements of a vector, matrix or array
  spv::StorageClass storage = spv::StorageClass::Function;
  std::vector<uint32_t> members;  ///< of a struct
  uint32_t stride = 0;            ///< ArrayStride, bytes
  bool is_2d = false;             ///< of an image
};

/// Where a member of a struct lies in memory, in bytes.
struct MemberLayout {
  uint32_t offset = 0;
  uint32_t matrix_stride = 0;
  bool row_major = false;
  std::string name;
};

struct Line {
  spv::Op op = spv::Op::OpNop;
  uint32_t type = 0, id = 0;       ///< 0: none
  std::vector<uint32_t> operands;  ///< behind these
  kernel::Location where;
};

struct Block {
  uint32_t label = 0;
  std::vector<Line> phis;
  std::vector<Line> lines;            ///< neither phis nor what follows here
  uint32_t merge = 0, continues = 0;  ///< of a structured header; continues: a loop's
  Line end;                           ///< the terminator
};

struct Variable {
  uint32_t type = 0;  ///< the pointer's
  spv::StorageClass storage = spv::StorageClass::Function;
  uint32_t initial = 0;
};

/// Decorations that lowering looks at.
struct Decorations {
  std::optional<uint32_t> set, binding, built_in, constant_id;
  bool no_contraction = false;
  bool block = false;
};

/// Throws InputError for SPIR-V that is broken, or uses what no shader here may.
class Module {
 public:
  /// `name`: of the file, for messages. `specialization`: constant_id -> bits. `number`: of the shader in its stage,
  /// whose shader record it has.
  Module(const std::vector<uint32_t>& words, const std::string& name,
         const std::map<uint32_t, uint32_t>& specialization = {}, uint32_t number = 0);

  spv::ExecutionModel stage() const { return stage_; }
  uint32_t number() const { return number_; }
  const std::string& name() const { return name_; }
  const Type& type(uint32_t id) const;
  const MemberLayout& layout(uint32_t struct_type, uint32_t member) const;
  const Decorations& decorations(uint32_t id) const;
  /// Of a variable, type or value; empty: it has none.
  const std::string& name_of(uint32_t id) const;
  const std::map<uint32_t, Variable>& variables() const { return variables_; }
  /// Constants and undefined values at the module's level, in order.
  const std::vector<Line>& constants() const { return constants_; }
  /// Of a value; 0: it has none.
  uint32_t type_of(uint32_t id) const;
  /// The bits of a scalar constant; nothing for another id.
  std::optional<uint32_t> constant(uint32_t id) const;
  const std::vector<Block>& blocks() const { return blocks_; }
  const Block& block(uint32_t label) const;
  const std::map<uint32_t, Line>& locals() const { return locals_; }  ///< variables of the function
  bool is_glsl_set(uint32_t id) const { return id == glsl_set_; }
  /// How often a value is used as an operand.
  uint32_t uses(uint32_t id) const;
  /// Scalars of 32 bits that a value of the type has; an integer of 64 bits has two, the low one first.
  uint32_t scalars(uint32_t type) const;
  bool is_wide(uint32_t type) const;

  [[noreturn]] void fail(const kernel::Location& where, const std::string& what) const;

 private:
  void read(const std::vector<uint32_t>& words, const std::map<uint32_t, uint32_t>& specialization);
  /// Names, decorations, and what the shader is; false: the instruction is none of these.
  bool read_name(spv::Op op, const std::vector<uint32_t>& operands);
  Line line_of(spv::Op op, const std::vector<uint32_t>& operands, const kernel::Location& where);
  void read_global(Line line, const std::map<uint32_t, uint32_t>& specialization);
  void read_type(spv::Op op, const std::vector<uint32_t>& operands);
  void decorate(uint32_t id, const std::vector<uint32_t>& operands);
  void decorate_member(const std::vector<uint32_t>& operands);
  void read_constant(Line line, const std::map<uint32_t, uint32_t>& specialization);
  void read_line(Line line, Block*& open);
  std::optional<uint32_t> fold(const Line& line) const;
  void count_uses();

  std::string name_;
  kernel::Location file_;
  uint32_t number_ = 0;
  spv::ExecutionModel stage_ = spv::ExecutionModel::Max;
  uint32_t entry_ = 0, glsl_set_ = 0;
  std::map<uint32_t, Type> types_;
  std::map<std::pair<uint32_t, uint32_t>, MemberLayout> members_;
  std::map<uint32_t, Decorations> decorations_;
  std::map<uint32_t, uint32_t> strides_;
  std::map<uint32_t, std::string> names_;
  std::map<uint32_t, const char*> files_;
  std::map<uint32_t, Variable> variables_;
  std::vector<Line> constants_;
  std::map<uint32_t, uint32_t> scalars_;  // of constants, their bits
  std::vector<Block> blocks_;
  std::unordered_map<uint32_t, size_t> block_at_;
  std::map<uint32_t, Line> locals_;
  std::unordered_map<uint32_t, uint32_t> uses_, types_of_values_;
};

/// The kind of shader record that shaders of a stage read.
RecordStage record_stage(spv::ExecutionModel stage);

/// A name that lives as long as the program, as places in kernels need it.
const char* lasting(const std::string& name);

}  // namespace raypool::shader
