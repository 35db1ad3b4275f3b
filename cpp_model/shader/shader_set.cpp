#include "shader/shader_set.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <optional>

#include "bits.hpp"
#include "config/data_folder.hpp"
#include "isa/did_you_mean.hpp"
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
constexpr std::array<Stage, 5> kStages = {{
    {".rgen", spv::ExecutionModel::RayGenerationKHR, "ray generation"},
    {".rchit", spv::ExecutionModel::ClosestHitKHR, "closest-hit"},
    {".rmiss", spv::ExecutionModel::MissKHR, "miss"},
    {".rahit", spv::ExecutionModel::AnyHitKHR, "any-hit"},
    {".rcall", spv::ExecutionModel::CallableKHR, "callable"},
}};
constexpr size_t kRayGeneration = 0, kClosestHit = 1, kMiss = 2, kAnyHit = 3, kCallable = 4;

// A ray that is waited for has 3 bits for the number of a miss shader or hit group, and 8 for that of its trace.
constexpr size_t kMostOfStage = 8;
constexpr uint32_t kMostSites = 255;

/// The ending that names the stage: of "a.rgen" and "a.rgen.spv" and "a.rgen.glsl".
std::string stage_ending(const fs::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".spv" || ending == ".glsl" ? file.stem().extension().string() : ending;
}
/// Without its stage: "a".
std::string name_of(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.substr(0, name.find(stage_ending(file)));
}

using Names = std::vector<std::string>;

/// Files of the folder, of each stage in the order of their names.
std::array<Names, kStages.size()> find_files(const fs::path& folder, const ShaderTable& table) {
  std::array<Names, kStages.size()> files;
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error) throw InputError(fmt::format("shaders {}: {}", folder.string(), error.message()));
  for (const fs::directory_entry& entry : entries) {
    const std::string ending = stage_ending(entry.path());
    if (ending == ".rint" && table.hit_groups.empty()) {
      throw InputError(
          fmt::format("{}: shaders of this stage are not supported: give the scene triangles, or leave the file out of "
                      "the hit_groups of shaders.json",
                      entry.path().string()));
    }
    for (size_t i = 0; i < kStages.size(); ++i)
      if (ending == kStages[i].ending) files[i].push_back(entry.path().filename().string());
  }
  for (Names& names : files) std::sort(names.begin(), names.end());
  for (const size_t i : {kRayGeneration, kClosestHit}) {
    if (files[i].empty()) {
      throw InputError(fmt::format("shaders {}: there is no {} shader: add a file with the ending {}", folder.string(),
                                   kStages[i].name, kStages[i].ending));
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
    member.is_address = scalar.kind == TypeKind::Pointer || module.is_wide(its);
    if (member.is_address) {
      member.is_float = false;
      member.row_stride = 8;
      members.push_back(member);
      continue;
    }
    if ((scalar.kind != TypeKind::Float && scalar.kind != TypeKind::Int) || scalar.bits != 32) continue;
    member.is_float = scalar.kind == TypeKind::Float;
    members.push_back(member);
  }
}

uint32_t end_of(const std::vector<Member>& members) {
  uint32_t end = 0;
  for (const Member& member : members) {
    end = std::max(end, member.offset + (member.elements - 1) * member.element_stride +
                            (member.columns - 1) * member.column_stride + (member.rows - 1) * member.row_stride +
                            (member.is_address ? 8 : 4));
  }
  return end;
}

/// A shader as SPIR-V.
struct File {
  std::string name;
  std::vector<uint32_t> words;
  bool has_record = false;
};

/// A shader of the table, which has its own shader record. Of a hit shader without one, all groups that have it.
struct Entry {
  size_t file = 0;
  uint32_t number = 0;
  std::vector<uint32_t> groups;
};

class Folder : public ShaderSet {
 public:
  Folder(const fs::path& folder, const ShaderTable& table) : folder_(folder.string()), unseen_(table.unseen) {
    const auto found = find_files(folder, table);
    add_ray_generation(found[kRayGeneration], table.ray_generation);
    for (const auto& [stage, names] : {std::pair(kMiss, table.misses), std::pair(kCallable, table.callables)})
      for (const std::string& name : names.empty() ? found[stage] : names) add_entry(stage, found[stage], name);
    const auto groups = table.hit_groups.empty() ? groups_of(found[kClosestHit], found[kAnyHit]) : table.hit_groups;
    for (const ShaderTable::HitGroup& group : groups) {
      if (!group.closest_hit.empty()) add_to_group(kClosestHit, found[kClosestHit], group.closest_hit);
      if (!group.any_hit.empty()) add_to_group(kAnyHit, found[kAnyHit], group.any_hit);
      ++groups_;
    }
    if (entries_[kClosestHit].empty()) {
      throw InputError(
          fmt::format("{}: no hit group of the set has a closest-hit shader: name one in shaders.json", folder_));
    }
    check_number(groups_, "hit groups");
    check_number(size32(entries_[kMiss]), "miss shaders");
    for (const size_t stage : {kRayGeneration, kClosestHit, kMiss, kAnyHit, kCallable}) {
      const std::vector<Entry>& entries = entries_[stage];
      if (stage != kRayGeneration && stage != kCallable) waits_ |= entries.size() > (stage == kAnyHit ? 0 : 1);
      for (const Entry& entry : entries) add_record(stage, entry);
    }
    waits_ |= groups_ > 1;
  }

  const std::string& folder() const override { return folder_; }
  const std::vector<Binding>& bindings() const override { return bindings_; }
  const std::vector<Member>& push_constants() const override { return push_constants_; }
  const std::vector<ShaderRecord>& shader_records() const override { return records_; }
  bool waits() const override { return waits_; }
  uint32_t path_words(const std::map<uint32_t, uint32_t>& specialization, uint32_t levels) const override {
    return waits_ ? shader::path_words(Modules(*this, specialization).waiting(), levels) : 0;
  }

  EnumArray<RayKernel, kernel::Function, kRayKernels> record(const Resources& resources, const KernelTarget& target,
                                                             const RecordLayout& layout) const override {
    const Modules modules(*this, resources.specialization);
    EnumArray<RayKernel, kernel::Function, kRayKernels> functions;
    const auto nothing = [&](RayKernel kernel) {
      functions[kernel] = kernel::record_kernel(
          std::string(kRayKernelNames[kernel]), [](auto& k) { k.ray_in(); }, target, layout);
    };
    const WaitingShaders shaders = modules.waiting();
    if (waits_) {
      for (const RayKernel kernel : {RayKernel::CastEye, RayKernel::CastSecondary})
        functions[kernel] = lower_waiting(shaders, resources, kernel, target, layout);
      nothing(RayKernel::CastSecondaryDirect);
      nothing(RayKernel::Shade);
      return functions;
    }
    const Module& closest_hit = modules.of(kClosestHit);
    if (entries_[kMiss].empty() && casts_shadow_rays(closest_hit)) {
      throw InputError(
          fmt::format("{}: it traces shadow rays, and no miss shader takes those that meet nothing: add a "
                      "file with the ending .rmiss",
                      closest_hit.name()));
    }
    const auto become = [&](RayKernel kernel, const Module& module) {
      functions[kernel] = lower(module, resources, kernel, target, layout, &shaders.callables);
    };
    become(RayKernel::CastEye, modules.of(kRayGeneration));
    become(RayKernel::CastSecondary, closest_hit);
    become(RayKernel::CastSecondaryDirect, closest_hit);
    if (entries_[kMiss].empty())
      nothing(RayKernel::Shade);
    else
      become(RayKernel::Shade, modules.of(kMiss));
    return functions;
  }

 private:
  template <typename Of>
  using Stages = std::array<std::vector<Of>, kStages.size()>;

  /// The shaders with values of their specialization constants, and where they wait.
  class Modules {
   public:
    Modules(const Folder& set, const std::map<uint32_t, uint32_t>& specialization) : set_(set) {
      uint32_t first = 1;
      for (size_t i = 0; i < kStages.size(); ++i) {
        for (const Entry& entry : set.entries_[i]) {
          const File& file = set.files_[i][entry.file];
          modules_[i].push_back(std::make_unique<Module>(file.words, file.name, specialization, entry.number));
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
      const auto one = [&](size_t stage, size_t i) { return WaitingShader{*modules_[stage][i], waits_[stage][i]}; };
      WaitingShaders all{one(kRayGeneration, 0), {}, {}, {}, {}, set_.groups_};
      for (size_t i = 0; i < modules_[kMiss].size(); ++i) all.misses.push_back(one(kMiss, i));
      for (size_t i = 0; i < modules_[kClosestHit].size(); ++i)
        all.closest_hits.push_back({one(kClosestHit, i), set_.entries_[kClosestHit][i].groups});
      for (size_t i = 0; i < modules_[kAnyHit].size(); ++i)
        all.any_hits.push_back({*modules_[kAnyHit][i], set_.entries_[kAnyHit][i].groups});
      for (const auto& module : modules_[kCallable]) all.callables.push_back(module.get());
      return all;
    }

   private:
    const Folder& set_;
    Stages<std::unique_ptr<Module>> modules_;
    Stages<Waits> waits_;
  };

  // ---- The table

  void check_number(uint32_t number, const char* what) const {
    if (number > kMostOfStage)
      throw InputError(
          fmt::format("{}: it has {} {}, and may have {}: merge some", folder_, number, what, kMostOfStage));
  }

  /// The file of this name, which is read the first time that it is wanted.
  size_t file_of(size_t stage, const Names& found, const std::string& name) {
    if (std::find(found.begin(), found.end(), name) == found.end()) {
      throw InputError(fmt::format("{}: shaders.json names '{}' where it wants a {} shader of the folder{}", folder_,
                                   name, kStages[stage].name,
                                   did_you_mean(name, found, fmt::format("there are {}", fmt::join(found, ", ")))));
    }
    const std::string path = (fs::path(folder_) / name).string();
    std::vector<File>& files = files_[stage];
    for (size_t i = 0; i < files.size(); ++i)
      if (files[i].name == path) return i;
    files.push_back({path, spirv_of(path)});
    const Module module(files.back().words, path);
    if (module.stage() != kStages[stage].model)
      throw InputError(fmt::format("{}: not the {} shader that its extension promises", path, kStages[stage].name));
    reflect(module);
    files.back().has_record = std::any_of(module.variables().begin(), module.variables().end(), [](const auto& one) {
      return one.second.storage == spv::StorageClass::ShaderRecordBufferKHR;
    });
    if (stage == kCallable && !find_waits(module).sites.empty())
      module.fail(find_waits(module).sites[0].line->where,
                  "a callable shader traces a ray: trace it in the shader that calls it");
    waits_ |= find_waits(module).needed;
    return files.size() - 1;
  }
  void add_entry(size_t stage, const Names& found, const std::string& name) {
    const size_t file = file_of(stage, found, name);
    entries_[stage].push_back({file, size32(entries_[stage]), {}});
  }
  void add_ray_generation(const Names& found, const std::string& name) {
    if (name.empty() && found.size() > 1) {
      throw InputError(
          fmt::format("{}: the folder has a second {} shader, {}: keep one, or name the one to run in "
                      "shaders.json",
                      (fs::path(folder_) / found[0]).string(), kStages[kRayGeneration].name, found[1]));
    }
    add_entry(kRayGeneration, found, name.empty() ? found.at(0) : name);
  }
  void add_to_group(size_t stage, const Names& found, const std::string& name) {
    const size_t file = file_of(stage, found, name);
    std::vector<Entry>& entries = entries_[stage];
    for (Entry& entry : entries)
      if (entry.file == file && !files_[stage][file].has_record) return entry.groups.push_back(groups_);
    entries.push_back({file, groups_, {groups_}});
  }
  /// A hit group for each closest-hit shader.
  std::vector<ShaderTable::HitGroup> groups_of(const Names& closest_hits, const Names& any_hits) const {
    std::vector<ShaderTable::HitGroup> groups;
    for (const std::string& name : closest_hits) groups.push_back({name, any_hits.size() == 1 ? any_hits[0] : ""});
    for (const std::string& name : any_hits) {
      if (any_hits.size() == 1) break;
      bool found = false;
      for (ShaderTable::HitGroup& group : groups) {
        if (name_of(group.closest_hit) != name_of(name)) continue;
        group.any_hit = name;
        found = true;
      }
      if (!found) {
        throw InputError(
            fmt::format("{}: no closest-hit shader has its name, so it is in no hit group: name it as one "
                        "of them, or list the hit_groups in shaders.json",
                        (fs::path(folder_) / name).string()));
      }
    }
    return groups;
  }
  void add_record(size_t stage, const Entry& entry) {
    const File& file = files_[stage][entry.file];
    if (!file.has_record) return;
    const Module module(file.words, file.name);
    ShaderRecord record{{record_stage(kStages[stage].model), entry.number}, file.name, {}, 0};
    for (const auto& [id, variable] : module.variables()) {
      if (variable.storage == spv::StorageClass::ShaderRecordBufferKHR)
        add_members(module, module.type(variable.type).element, "", 0, record.members);
    }
    record.bytes = end_of(record.members);
    // The shaders of a hit group share its record.
    for (ShaderRecord& other : records_) {
      if (other.place != record.place) continue;
      if (other.bytes < record.bytes) other = record;
      return;
    }
    records_.push_back(record);
  }

  void check_picture(const Module& module, uint32_t type, const Binding& binding) const {
    if (!module.type(type).is_2d || module.type(module.type(type).element).kind != TypeKind::Float) {
      throw InputError(
          fmt::format("{}: image '{}' is not an image2D of floats, and only the picture can be written: "
                      "declare it rgba32f image2D",
                      module.name(), binding.name));
    }
    const auto is_seen = [&](const Binding& one) { return unseen_.count(one.place) == 0; };
    for (const Binding& other : bindings_) {
      const bool is_other = other.kind == BindingKind::Picture && other.place != binding.place;
      if (!is_other || !is_seen(other) || !is_seen(binding)) continue;
      throw InputError(
          fmt::format("{}: image '{}' is a second one beside '{}', and there is but one picture to write: "
                      "let one of them hold \"nothing\" in shaders.json",
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
  std::set<Place> unseen_;
  Stages<File> files_;
  Stages<Entry> entries_;
  uint32_t groups_ = 0;
  bool waits_ = false;
  std::vector<ShaderRecord> records_;
  std::vector<Binding> bindings_;
  std::vector<Member> push_constants_;
};

}  // namespace

std::string ShaderSet::find(const std::string& folder) {
  std::error_code missing;
  if (fs::is_directory(folder, missing)) return folder;
  const fs::path own = fs::path(data_folder()) / "shaders" / folder;
  if (!folder.empty() && folder.find('/') == std::string::npos && fs::is_directory(own, missing)) return own.string();
  throw InputError(fmt::format("shaders {}: there is no such folder, nor one of this name in {}", folder,
                               own.parent_path().string()));
}

std::shared_ptr<const ShaderSet> ShaderSet::load(const std::string& folder, const ShaderTable& table) {
  return std::make_shared<Folder>(find(folder), table);
}

}  // namespace raypool::shader
