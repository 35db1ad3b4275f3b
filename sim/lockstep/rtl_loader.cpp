#include "lockstep/rtl_loader.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>
#include <utility>

#include "rtl/unit_library.hpp"

namespace raypool {
namespace {

// A loaded library; unloaded with the last unit that came from it.
class Library {
 public:
  explicit Library(const std::string& path) : path_(path) {
    if (!std::filesystem::exists(path)) {
      throw InputError(
          path +
          ": there is no Verilated compute unit; build it with scripts/verilate.sh (make does it with ENGINE=rtl)");
    }
    // A path without a slash would be looked for in the system's folders.
    handle_ = dlopen(std::filesystem::absolute(path).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle_ == nullptr)
      throw InputError(path + ": the Verilated compute unit cannot be loaded (" + dlerror() + "); build it again");
  }
  ~Library() {
    if (handle_ != nullptr) dlclose(handle_);
  }
  Library(Library&& other) noexcept : path_(std::move(other.path_)), handle_(std::exchange(other.handle_, nullptr)) {}
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  template <typename Function>
  Function* find(const char* name) const {
    void* symbol = dlsym(handle_, name);
    if (symbol == nullptr)
      throw InputError(path_ + ": this library is no Verilated compute unit (it has no " + name + "); build it again");
    return reinterpret_cast<Function*>(symbol);
  }

 private:
  std::string path_;
  void* handle_ = nullptr;
};

void check_parameters(const std::string& path, const std::string& text, const Configuration& configuration, int units) {
  std::map<std::string, int> built = {{"UNITS", 1}};
  std::istringstream stream(text);
  for (std::string item; stream >> item;) {
    const size_t equals = item.find('=');
    built[item.substr(0, equals)] = std::atoi(item.c_str() + equals + 1);
  }
  auto needed = verilog_parameters(configuration);
  needed.emplace_back("UNITS", units);
  for (const auto& [name, value] : needed) {
    const auto found = built.find(name);
    if (found != built.end() && found->second == value) continue;
    throw InputError(path + ": the Verilated compute unit was built " +
                     (found == built.end() ? "without " + name : "with " + name + "=" + std::to_string(found->second)) +
                     ", configuration " + configuration.name + " needs " + name + "=" + std::to_string(value) +
                     "; build it for this configuration with scripts/verilate.sh");
  }
}

// Keeps the library as long as the unit.
class LoadedUnit : public ComputeUnit {
 public:
  LoadedUnit(Library library, const Configuration& configuration)
      : library_(std::move(library)), unit_(library_.find<CreateUnit>(kCreateUnitName)(configuration)) {}

  uint32_t units() const override { return unit_->units(); }
  void reset(uint32_t program_length, uint32_t memory_limit) override { unit_->reset(program_length, memory_limit); }
  void set_argument(uint32_t index, uint32_t value) override { unit_->set_argument(index, value); }
  const UnitOutputs& outputs() const override { return unit_->outputs(); }
  void clock(const UnitInputs& inputs) override { unit_->clock(inputs); }
  void trace_on() override { unit_->trace_on(); }
  const UnitTrace& trace() const override { return unit_->trace(); }
  Signal signal(const std::string& scope, const std::string& name) const override { return unit_->signal(scope, name); }
  uint64_t counter(int number) override { return unit_->counter(number); }
  bool timed() const override { return unit_->timed(); }
  void open_waveform(const std::string& path) override { unit_->open_waveform(path); }

 private:
  Library library_;  // destroyed after the unit
  std::unique_ptr<ComputeUnit> unit_;
};

}  // namespace

std::unique_ptr<ComputeUnit> load_rtl_unit(const std::string& library_path, const Configuration& configuration,
                                           int units) {
  Library library(library_path);
  const std::string interface = library.find<UnitText>(kUnitInterfaceName)();
  if (interface != unit_interface()) {
    throw InputError(library_path +
                     ": the Verilated compute unit was built against another version of the compute-unit interface (" +
                     interface + " instead of " + unit_interface() + "); build it again with scripts/verilate.sh");
  }
  check_parameters(library_path, library.find<UnitText>(kUnitParametersName)(), configuration, units);
  return std::make_unique<LoadedUnit>(std::move(library), configuration);
}

}  // namespace raypool
