#include "lockstep/rtl_loader.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

#include "files/unfinished.hpp"
#include "rtl/chip_library.hpp"
#include "rtl/unit_library.hpp"

namespace raypool {
namespace {

using Parameters = std::vector<std::pair<std::string, int>>;

// A loaded library; unloaded with the last device that came from it.
class Library {
 public:
  Library(const std::string& path, const LibraryNames& names) : path_(path), names_(&names) {
    if (!std::filesystem::exists(path)) {
      throw InputError(path + ": there is no Verilated " + names.what +
                       "; build it with scripts/verilate.sh (make does it with ENGINE=rtl)");
    }
    // A path without a slash would be looked for in the system's folders.
    handle_ = dlopen(std::filesystem::absolute(path).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle_ == nullptr)
      throw InputError(path + ": the Verilated " + names.what + " cannot be loaded (" + dlerror() +
                       "); build it again");
  }
  ~Library() {
    if (handle_ != nullptr) dlclose(handle_);
  }
  Library(Library&& other) noexcept
      : path_(std::move(other.path_)), names_(other.names_), handle_(std::exchange(other.handle_, nullptr)) {}
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  /// Checks that it fits, and makes a device.
  template <typename Device>
  std::unique_ptr<Device> create(const Configuration& configuration, const std::string& interface,
                                 const Parameters& parameters) const {
    const std::string built = find<LibraryText>(names_->interface)();
    if (built != interface) {
      throw InputError(path_ + ": the Verilated " + names_->what + " was built against another version of the " +
                       "interface (" + built + " instead of " + interface +
                       "); build it again with scripts/verilate.sh");
    }
    check_parameters(configuration, parameters);
    return std::unique_ptr<Device>(find<Create<Device>>(names_->create)(configuration));
  }

 private:
  template <typename Function>
  Function* find(const char* name) const {
    void* symbol = dlsym(handle_, name);
    if (symbol == nullptr)
      throw InputError(path_ + ": this library is no Verilated " + names_->what + " (it has no " + name +
                       "); build it again");
    return reinterpret_cast<Function*>(symbol);
  }

  void check_parameters(const Configuration& configuration, const Parameters& needed) const {
    std::map<std::string, int> built = {{"UNITS", 1}};
    std::istringstream stream(find<LibraryText>(names_->parameters)());
    for (std::string item; stream >> item;) {
      const size_t equals = item.find('=');
      built[item.substr(0, equals)] = std::atoi(item.c_str() + equals + 1);
    }
    for (const auto& [name, value] : needed) {
      const auto found = built.find(name);
      if (found != built.end() && found->second == value) continue;
      throw InputError(
          path_ + ": the Verilated " + names_->what + " was built " +
          (found == built.end() ? "without " + name : "with " + name + "=" + std::to_string(found->second)) +
          ", configuration " + configuration.name + " needs " + name + "=" + std::to_string(value) +
          "; build it for this configuration with scripts/verilate.sh");
    }
  }

  std::string path_;
  const LibraryNames* names_;
  void* handle_ = nullptr;
};

// Keeps the library as long as the unit.
class LoadedUnit : public ComputeUnit {
 public:
  LoadedUnit(const std::string& path, const Configuration& configuration, const Parameters& parameters)
      : library_(path, kUnitLibrary),
        unit_(library_.create<ComputeUnit>(configuration, unit_interface(), parameters)) {}

  uint32_t units() const override { return unit_->units(); }
  void reset(uint32_t program_length, uint32_t memory_limit) override { unit_->reset(program_length, memory_limit); }
  void set_argument(uint32_t index, uint32_t value) override { unit_->set_argument(index, value); }
  const UnitOutputs& outputs() const override { return unit_->outputs(); }
  void clock(const UnitInputs& inputs) override {
    stop_point();
    unit_->clock(inputs);
  }
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

class LoadedChip : public ChipDevice {
 public:
  LoadedChip(const std::string& path, const Configuration& configuration, const Parameters& parameters)
      : library_(path, kChipLibrary), chip_(library_.create<ChipDevice>(configuration, chip_interface(), parameters)) {}

  uint32_t units() const override { return chip_->units(); }
  void start(const FrameSetup& setup) override { chip_->start(setup); }
  void start_next(const FrameSetup& setup) override { chip_->start_next(setup); }
  const ChipOutputs& outputs() const override { return chip_->outputs(); }
  void clock(const ChipInputs& inputs) override {
    stop_point();
    chip_->clock(inputs);
  }
  void settle(const ChipInputs& inputs) override { chip_->settle(inputs); }
  ChipCounts counts() override { return chip_->counts(); }
  uint64_t counter(int number) override { return chip_->counter(number); }
  void open_waveform(const std::string& path) override { chip_->open_waveform(path); }
  Signal signal(const std::string& scope, const std::string& name) const override { return chip_->signal(scope, name); }

 private:
  Library library_;  // destroyed after the chip
  std::unique_ptr<ChipDevice> chip_;
};

}  // namespace

std::unique_ptr<ComputeUnit> load_rtl_unit(const std::string& library_path, const Configuration& configuration,
                                           int units) {
  Parameters needed = verilog_parameters(configuration);
  needed.emplace_back("UNITS", units);
  return std::make_unique<LoadedUnit>(library_path, configuration, needed);
}

std::unique_ptr<ChipDevice> load_rtl_chip(const std::string& library_path, const Configuration& configuration,
                                          int units) {
  return std::make_unique<LoadedChip>(library_path, configuration, chip_verilog_parameters(configuration, units));
}

}  // namespace raypool
