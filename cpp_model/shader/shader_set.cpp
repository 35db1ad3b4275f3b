#include "shader/shader_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>

#include "bits.hpp"
#include "config/data_folder.hpp"
#include "isa/input_error.hpp"
#include "shader/glsl.hpp"
#include "shader/lowering.hpp"
#include "shader/module.hpp"
#include "shader/waits.hpp"

namespace raypool::shader {
namespace {

namespace fs = std::filesystem;

struct Stage {
  const char* ending;
  spv::ExecutionModel model;
  const char* name;
};
constexpr std::array<Stage, 4> kStages = {{
    {".rgen", spv::ExecutionModel::RayGenerationKHR, "ray generation"},
    {".rchit", spv::ExecutionModel::ClosestHitKHR, "closest-hit"},
    {".rmiss", spv::ExecutionModel::MissKHR, "miss"},
    {".rahit", spv::ExecutionModel::AnyHitKHR, "any-hit"},
}};

// A ray that is waited for has 3 bits for the number of a shader, and 8 for that of its trace.
constexpr size_t kMostOfStage = 8;
constexpr uint32_t kMostSites = 255;

constexpr size_t kRayGeneration = 0, kClosestHit = 1, kMiss = 2, kAnyHit = 3;

/// The ending that names the stage: of "a.rgen" and "a.rgen.spv" and "a.rgen.glsl".
std::string stage_ending(const fs::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".spv" || ending == ".glsl" ? file.stem().extension().string() : ending;
}

/// Files of the folder, of each stage in the order of their names.
std::array<std::vector<fs::path>, kStages.size()> find_files(const fs::path& folder) {
  std::array<std::vector<fs::path>, kStages.size()> files;
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error) throw InputError(fmt::format("shaders {}: {}", folder.string(), error.message()));
  for (const fs::directory_entry& entry : entries) {
    const std::string ending = stage_ending(entry.path());
    for (const auto& [other, instead] :
         {std::pair(".rint", "give the scene triangles"), std::pair(".rcall", "write a function")}) {
      if (ending == other)
        throw InputError(
            fmt::format("{}: shaders of this stage are not supported: {}", entry.path().string(), instead));
    }
    for (size_t i = 0; i < kStages.size(); ++i)
      if (ending == kStages[i].ending) files[i].push_back(entry.path());
  }
  for (size_t i = 0; i < kStages.size(); ++i) {
    std::sort(files[i].begin(), files[i].end());
    if (files[i].empty() && i < kMiss) {
      throw InputError(fmt::format("shaders {}: there is no {} shader: add a file with the ending {}", folder.string(),
                                   kStages[i].name, kStages[i].ending));
    }
  }
  if (files[kRayGeneration].size() > 1) {
    throw InputError(fmt::format("{}: the folder has a second {} shader, {}: keep one",
                                 files[kRayGeneration][0].string(), kStages[kRayGeneration].name,
                                 files[kRayGeneration][1].filename().string()));
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

/// A shader as SPIR-V.
struct File {
  std::string name;
  std::vector<uint32_t> words;
};

class Folder : public ShaderSet {
 public:
  explicit Folder(const fs::path& folder) : folder_(folder.string()) {
    const auto files = find_files(folder);
    for (size_t i = 0; i < kStages.size(); ++i) {
      for (const fs::path& path : files[i]) {
        files_[i].push_back({path.string(), spirv_of(path.string())});
        const Module module(files_[i].back().words, files_[i].back().name);
        if (module.stage() != kStages[i].model)
          throw InputError(fmt::format("{}: it is no {} shader, as its ending says", module.name(), kStages[i].name));
        reflect(module);
        waits_ |= i == kAnyHit || files_[i].size() > 1 || find_waits(module).needed;
      }
    }
  }

  const std::string& folder() const override { return folder_; }
  const std::vector<Binding>& bindings() const override { return bindings_; }
  const std::vector<Member>& push_constants() const override { return push_constants_; }
  bool waits() const override { return waits_; }
  uint32_t path_words(const std::map<uint32_t, uint32_t>& specialization) const override {
    return waits_ ? shader::path_words(Modules(files_, specialization).waiting()) : 0;
  }

  EnumArray<RayKernel, kernel::Function, kRayKernels> record(const Resources& resources, const KernelTarget& target,
                                                             const RecordLayout& layout) const override {
    const Modules modules(files_, resources.specialization);
    EnumArray<RayKernel, kernel::Function, kRayKernels> functions;
    const auto nothing = [&](RayKernel kernel) {
      functions[kernel] = kernel::record_kernel(
          std::string(kRayKernelNames[kernel]), [](auto& k) { k.ray_in(); }, target, layout);
    };
    if (waits_) {
      const WaitingShaders shaders = modules.waiting();
      for (const RayKernel kernel : {RayKernel::CastEye, RayKernel::CastSecondary})
        functions[kernel] = lower_waiting(shaders, resources, kernel, target, layout);
      nothing(RayKernel::CastSecondaryDirect);
      nothing(RayKernel::Shade);
      return functions;
    }
    const Module& closest_hit = modules.of(kClosestHit);
    if (files_[kMiss].empty() && casts_shadow_rays(closest_hit)) {
      throw InputError(
          fmt::format("{}: it traces shadow rays, and no miss shader takes those that meet nothing: add a "
                      "file with the ending .rmiss",
                      closest_hit.name()));
    }
    const auto become = [&](RayKernel kernel, const Module& module) {
      functions[kernel] = lower(module, resources, kernel, target, layout);
    };
    become(RayKernel::CastEye, modules.of(kRayGeneration));
    become(RayKernel::CastSecondary, closest_hit);
    become(RayKernel::CastSecondaryDirect, closest_hit);
    if (files_[kMiss].empty())
      nothing(RayKernel::Shade);
    else
      become(RayKernel::Shade, modules.of(kMiss));
    return functions;
  }

 private:
  using Files = std::array<std::vector<File>, kStages.size()>;

  /// The shaders with values of their specialization constants, and where they wait.
  class Modules {
   public:
    Modules(const Files& files, const std::map<uint32_t, uint32_t>& specialization) {
      uint32_t first = 1;
      for (size_t i = 0; i < kStages.size(); ++i) {
        if (files[i].size() > kMostOfStage) {
          throw InputError(fmt::format("{}: it is the {}th {} shader of its set, which may have {}: merge some",
                                       files[i][kMostOfStage].name, kMostOfStage + 1, kStages[i].name, kMostOfStage));
        }
        for (const File& file : files[i]) {
          modules_[i].push_back(std::make_unique<Module>(file.words, file.name, specialization));
          waits_[i].push_back(find_waits(*modules_[i].back(), first));
          first += size32(waits_[i].back().sites);
          if (first > kMostSites + 1) {
            throw InputError(
                fmt::format("{}: with its calls of traceRayEXT the set has {}, and may have {}: put some "
                            "into loops",
                            file.name, first - 1, kMostSites));
          }
        }
      }
    }
    const Module& of(size_t stage) const { return *modules_[stage].at(0); }
    WaitingShaders waiting() const {
      const auto all = [&](size_t stage) {
        std::vector<WaitingShader> shaders;
        for (size_t i = 0; i < modules_[stage].size(); ++i) shaders.push_back({*modules_[stage][i], waits_[stage][i]});
        return shaders;
      };
      return {all(kRayGeneration).at(0), all(kMiss), all(kClosestHit), any_hits()};
    }

   private:
    /// One alone is asked of all hits, others of those of the closest-hit shader of their name.
    std::vector<AnyHitShader> any_hits() const {
      const auto name_of = [](const Module& module) {
        const std::string name = fs::path(module.name()).filename().string();
        return name.substr(0, name.find(stage_ending(name)));
      };
      std::vector<AnyHitShader> shaders;
      for (const auto& module : modules_[kAnyHit]) {
        AnyHitShader shader{*module, {}};
        for (uint32_t i = 0; i < modules_[kClosestHit].size(); ++i)
          if (modules_[kAnyHit].size() == 1 || name_of(*modules_[kClosestHit][i]) == name_of(*module))
            shader.closest_hits.push_back(i);
        if (shader.closest_hits.empty()) {
          throw InputError(
              fmt::format("{}: no closest-hit shader has its name, so it belongs to no hits: name it as one of them",
                          module->name()));
        }
        shaders.push_back(std::move(shader));
      }
      return shaders;
    }

    std::array<std::vector<std::unique_ptr<Module>>, kStages.size()> modules_;
    std::array<std::vector<Waits>, kStages.size()> waits_;
  };

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
    const Waits waits = find_waits(module);
    return std::any_of(waits.sites.begin(), waits.sites.end(),
                       [&](const TraceSite& site) { return is_shadow(module, *site.line); });
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
  Files files_;
  bool waits_ = false;
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
