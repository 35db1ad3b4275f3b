#include "shader/shader_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>

#include "config/data_folder.hpp"
#include "isa/input_error.hpp"
#include "shader/glsl.hpp"
#include "shader/lowering.hpp"
#include "shader/module.hpp"

namespace raypool::shader {
namespace {

namespace fs = std::filesystem;

struct Stage {
  const char* ending;
  spv::ExecutionModel model;
  const char* name;
};
constexpr std::array<Stage, 3> kStages = {{
    {".rgen", spv::ExecutionModel::RayGenerationKHR, "ray generation"},
    {".rchit", spv::ExecutionModel::ClosestHitKHR, "closest-hit"},
    {".rmiss", spv::ExecutionModel::MissKHR, "miss"},
}};

/// The ending that names the stage: of "a.rgen" and "a.rgen.spv" and "a.rgen.glsl".
std::string stage_ending(const fs::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".spv" || ending == ".glsl" ? file.stem().extension().string() : ending;
}

/// Files of the folder, of each stage at most one.
std::array<fs::path, kStages.size()> find_files(const fs::path& folder) {
  std::array<fs::path, kStages.size()> files;
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error) throw InputError(fmt::format("shaders {}: {}", folder.string(), error.message()));
  for (const fs::directory_entry& entry : entries) {
    const std::string ending = stage_ending(entry.path());
    for (const auto& [other, instead] :
         {std::pair(".rahit", "decide in the closest-hit shader, and trace on from behind the hit"),
          std::pair(".rint", "give the scene triangles"), std::pair(".rcall", "write a function")}) {
      if (ending == other)
        throw InputError(
            fmt::format("{}: shaders of this stage are not supported: {}", entry.path().string(), instead));
    }
    for (size_t i = 0; i < kStages.size(); ++i) {
      if (ending != kStages[i].ending) continue;
      if (!files[i].empty()) {
        throw InputError(fmt::format("{}: the folder has a second {} shader, {}: keep one", files[i].string(),
                                     kStages[i].name, entry.path().filename().string()));
      }
      files[i] = entry.path();
    }
  }
  for (const size_t needed : {size_t{0}, size_t{1}}) {
    if (files[needed].empty()) {
      throw InputError(fmt::format("shaders {}: there is no {} shader: add a file with the ending {}", folder.string(),
                                   kStages[needed].name, kStages[needed].ending));
    }
  }
  return files;
}

/// Members of a block, those of structs inside by "outer.inner".
void add_members(const Module& module, uint32_t type, const std::string& prefix, uint32_t offset,
                 std::vector<Member>& members) {
  const Type& block = module.type(type);
  for (uint32_t m = 0; m < block.members.size(); ++m) {
    const MemberLayout& layout = module.layout(type, m);
    Member member;
    member.name = prefix + layout.name;
    member.offset = offset + layout.offset;
    uint32_t its = block.members[m];
    if (module.type(its).kind == TypeKind::Struct) {
      add_members(module, its, member.name + ".", member.offset, members);
      continue;
    }
    if (module.type(its).kind == TypeKind::Array) {
      member.elements = module.type(its).count;
      member.element_stride = module.type(its).stride;
      its = module.type(its).element;
    }
    if (module.type(its).kind == TypeKind::Matrix) {
      member.columns = module.type(its).count;
      its = module.type(its).element;
      member.column_stride = layout.row_major ? 4 : layout.matrix_stride;
      member.row_stride = layout.row_major ? layout.matrix_stride : 4;
    }
    if (module.type(its).kind == TypeKind::Vector) {
      member.rows = module.type(its).count;
      its = module.type(its).element;
    }
    const Type& scalar = module.type(its);
    if ((scalar.kind != TypeKind::Float && scalar.kind != TypeKind::Int) || scalar.bits != 32) continue;
    member.is_float = scalar.kind == TypeKind::Float;
    members.push_back(member);
  }
}

uint32_t end_of(const std::vector<Member>& members) {
  uint32_t end = 0;
  for (const Member& member : members) {
    end = std::max(end, member.offset + (member.elements - 1) * member.element_stride +
                            (member.columns - 1) * member.column_stride + (member.rows - 1) * member.row_stride + 4);
  }
  return end;
}

class Folder : public ShaderSet {
 public:
  explicit Folder(const fs::path& folder) : folder_(folder.string()) {
    const auto files = find_files(folder);
    for (size_t i = 0; i < kStages.size(); ++i) {
      if (files[i].empty()) continue;
      names_[i] = files[i].string();
      words_[i] = spirv_of(names_[i]);
      const Module module(words_[i], names_[i]);
      if (module.stage() != kStages[i].model)
        throw InputError(fmt::format("{}: it is no {} shader, as its ending says", names_[i], kStages[i].name));
      reflect(module);
    }
  }

  const std::string& folder() const override { return folder_; }
  const std::vector<Binding>& bindings() const override { return bindings_; }
  const std::vector<Member>& push_constants() const override { return push_constants_; }

  EnumArray<RayKernel, kernel::Function, kRayKernels> record(const Resources& resources, const KernelTarget& target,
                                                             const RecordLayout& layout) const override {
    std::array<std::optional<Module>, kStages.size()> modules;
    for (size_t i = 0; i < kStages.size(); ++i)
      if (!words_[i].empty()) modules[i].emplace(words_[i], names_[i], resources.specialization);
    EnumArray<RayKernel, kernel::Function, kRayKernels> functions;
    functions[RayKernel::CastEye] = lower(*modules[0], resources, RayKernel::CastEye, target, layout);
    if (!modules[2] && casts_shadow_rays(*modules[1])) {
      throw InputError(
          fmt::format("{}: it traces shadow rays, and no miss shader takes those that meet nothing: add a "
                      "file with the ending .rmiss",
                      names_[1]));
    }
    functions[RayKernel::CastSecondary] = lower(*modules[1], resources, RayKernel::CastSecondary, target, layout);
    functions[RayKernel::CastSecondaryDirect] =
        lower(*modules[1], resources, RayKernel::CastSecondaryDirect, target, layout);
    functions[RayKernel::Shade] =
        modules[2] ? lower(*modules[2], resources, RayKernel::Shade, target, layout)
                   : kernel::record_kernel(
                         std::string(kRayKernelNames[RayKernel::Shade]), [](auto& k) { k.ray_in(); }, target, layout);
    return functions;
  }

 private:
  void check_picture(const Module& module, uint32_t type, const Binding& binding) const {
    if (!module.type(type).is_2d || module.type(module.type(type).element).kind != TypeKind::Float) {
      throw InputError(
          fmt::format("{}: image '{}' is no image2D of floats, and there is but the picture to write: "
                      "declare it rgba32f image2D",
                      module.name(), binding.name));
    }
    for (const Binding& other : bindings_) {
      if (other.kind != BindingKind::Picture || other.place == binding.place) continue;
      throw InputError(
          fmt::format("{}: image '{}' is a second one beside '{}', and there is but one picture to write: "
                      "use one",
                      module.name(), binding.name, other.name));
    }
  }

  static bool casts_shadow_rays(const Module& module) {
    for (const Block& block : module.blocks())
      for (const Line& line : block.lines)
        if (line.op == spv::Op::OpTraceRayKHR && (module.constant(line.operands.at(1)).value_or(0) & kShadowRay) != 0)
          return true;
    return false;
  }

  void reflect(const Module& module) {
    for (const auto& [id, variable] : module.variables()) {
      const Decorations& decorations = module.decorations(id);
      uint32_t type = module.type(variable.type).element;
      if (variable.storage == spv::StorageClass::PushConstant) {
        std::vector<Member> members;
        add_members(module, type, "", 0, members);
        if (members.size() > push_constants_.size()) push_constants_ = members;
        continue;
      }
      Binding binding;
      binding.place = {decorations.set.value_or(0), decorations.binding.value_or(0)};
      binding.name = module.name_of(id).empty() ? module.name_of(type) : module.name_of(id);
      switch (variable.storage) {
        case spv::StorageClass::Uniform:
        case spv::StorageClass::StorageBuffer:
          binding.kind = variable.storage == spv::StorageClass::Uniform ? BindingKind::Block : BindingKind::Buffer;
          if (module.type(type).kind == TypeKind::Struct) add_members(module, type, "", 0, binding.members);
          binding.bytes = end_of(binding.members);
          break;
        case spv::StorageClass::UniformConstant: {
          const TypeKind outer = module.type(type).kind;
          if (outer == TypeKind::Array || outer == TypeKind::RuntimeArray) type = module.type(type).element;
          const TypeKind kind = module.type(type).kind;
          binding.kind = kind == TypeKind::AccelerationStructure ? BindingKind::Tree
                         : kind == TypeKind::Image               ? BindingKind::Picture
                                                                 : BindingKind::Textures;
          if (kind == TypeKind::Image) check_picture(module, type, binding);
          break;
        }
        default:
          continue;
      }
      const auto known = std::find_if(bindings_.begin(), bindings_.end(),
                                      [&](const Binding& other) { return other.place == binding.place; });
      if (known == bindings_.end())
        bindings_.push_back(binding);
      else if (known->bytes < binding.bytes)
        *known = binding;
    }
  }

  std::string folder_;
  std::array<std::string, kStages.size()> names_;
  std::array<std::vector<uint32_t>, kStages.size()> words_;
  std::vector<Binding> bindings_;
  std::vector<Member> push_constants_;
};

}  // namespace

std::shared_ptr<const ShaderSet> ShaderSet::load(const std::string& folder) {
  std::error_code missing;
  if (fs::is_directory(folder, missing)) return std::make_shared<Folder>(folder);
  const fs::path own = fs::path(data_folder()) / "shaders" / folder;
  if (!folder.empty() && folder.find('/') == std::string::npos && fs::is_directory(own, missing))
    return std::make_shared<Folder>(own);
  throw InputError(fmt::format("shaders {}: there is no such folder, nor one of this name in {}", folder,
                               own.parent_path().string()));
}

}  // namespace raypool::shader
