// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A folder of ray-tracing shaders, and the ray kernels that they become. docs/use/shaders.md says what is supported.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "enum_array.hpp"
#include "kernel/intermediate.hpp"
#include "kernel/target.hpp"
#include "machine/chip/ray_kernel.hpp"
#include "machine/common/packages.hpp"
#include "shader/resources.hpp"

namespace raypool::shader {

/// What a binding of the set is declared as.
enum class BindingKind : uint8_t { Tree, Picture, Block, Buffer, Textures };

/// A member of a uniform block or of the push constants: scalars, vectors and matrices of floats or 32-bit integers,
/// addresses, and arrays of them.
struct Member {
  std::string name;
  uint32_t offset = 0;  ///< bytes
  uint32_t rows = 1, columns = 1, elements = 1;
  uint32_t row_stride = 4, column_stride = 0, element_stride = 0;  ///< bytes; a vector is a column
  bool is_float = true;
  bool is_address = false;  ///< of a buffer: 64 bits, of which the second word is 0
};

struct Binding {
  Place place;
  std::string name;  ///< of the variable, or of its block where the variable has none
  BindingKind kind = BindingKind::Buffer;
  std::vector<Member> members;  ///< of a Block
  uint32_t bytes = 0;           ///< of a Block, or of the sized part of a Buffer
};

/// Which shaders a set has, and in which order traceRayEXT and executeCallableEXT count them: names of files, of which
/// one may stand for several. A list that is empty has all files of its stage, in the order of their names; then an
/// any-hit shader goes with the closest-hit shader of its name, or with all if it is the only one.
struct ShaderTable {
  struct HitGroup {
    std::string closest_hit, any_hit;  ///< empty: none
  };
  std::string ray_generation;
  std::vector<std::string> misses, callables;
  std::vector<HitGroup> hit_groups;
  std::set<Place> unseen;  ///< pictures of which nothing is kept
};

/// The shader record (shaderRecordEXT) of an entry of the table.
struct ShaderRecord {
  RecordPlace place;
  std::string shader;  ///< its file
  std::vector<Member> members;
  uint32_t bytes = 0;
};

/// Throws InputError, with file and line where they are known, for what cannot be done.
class ShaderSet {
 public:
  /// Where a folder, or the folder of this name in shaders/, is.
  static std::string find(const std::string& folder);
  /// A folder with .rgen, .rchit, .rmiss, .rahit and .rcall files, each in GLSL or as SPIR-V (.rgen.spv ...).
  static std::shared_ptr<const ShaderSet> load(const std::string& folder, const ShaderTable& table = {});
  virtual ~ShaderSet() = default;

  virtual const std::string& folder() const = 0;
  /// Those that a shader of the set uses, each once.
  virtual const std::vector<Binding>& bindings() const = 0;
  virtual const std::vector<Member>& push_constants() const = 0;
  virtual const std::vector<ShaderRecord>& shader_records() const = 0;
  /// Whether a shader goes on when its ray has come back: the machine must have chip.miss_records, and a frame a depth
  /// of 2 or more, whatever the shaders' own. A set that does not wait ends with its traces.
  virtual bool waits() const = 0;
  /// What Resources::path_words must be, of so many Resources::levels.
  virtual uint32_t path_words(const std::map<uint32_t, uint32_t>& specialization, uint32_t levels) const = 0;
  /// The ray kernels, not yet compiled. CastSecondaryDirect is the closest-hit shader without rays that go on; of a set
  /// that waits it is not used.
  /// `layout`: of the intersections that they import.
  virtual EnumArray<RayKernel, kernel::Function, kRayKernels> record(const Resources& resources,
                                                                     const KernelTarget& target,
                                                                     const RecordLayout& layout) const = 0;
  auto record(const Resources& resources, const KernelTarget& target) const {
    return record(resources, target, RecordLayout{});
  }
};

}  // namespace raypool::shader
