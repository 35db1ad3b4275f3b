#include "machine/chip/chip_model.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "bits.hpp"
#include "machine/chip/controller.hpp"
#include "machine/chip/frame_port.hpp"
#include "machine/chip/intersection_pool.hpp"
#include "machine/chip/launches.hpp"
#include "machine/chip/ray_pool.hpp"
#include "machine/traverser/traverser.hpp"

namespace raypool {

namespace {

constexpr std::array<ImportKind, 3> kKinds = {ImportKind::Normal, ImportKind::Shadow, ImportKind::Direct};

/// As rtl/chip/rp_chip.v has them.
Traverser::Sizes traverser_sizes(const Configuration& configuration) {
  const ChipConfiguration& chip = configuration.chip;
  constexpr uint32_t kLine = MemoryLine::kBytes;
  Traverser::Sizes sizes;
  sizes.lanes = chip.hardware_traverser_lanes;
  sizes.slots = chip.hardware_traverser_rays / sizes.lanes;
  sizes.stack_entries = chip.hardware_traverser_stack_entries;
  sizes.box_bits = static_cast<int>(chip.hardware_traverser_box_bits);
  sizes.triangle_pipes = chip.hardware_traverser_triangle_pipes;
  sizes.nodes.lines = chip.hardware_traverser_node_cache_bytes / kLine;
  sizes.nodes.ways = chip.hardware_traverser_node_cache_ways;
  sizes.nodes.mshrs = chip.hardware_traverser_node_cache_mshrs;
  sizes.leaves.lines = chip.hardware_traverser_triangle_cache_bytes / kLine;
  sizes.leaves.ways = chip.hardware_traverser_triangle_cache_ways;
  sizes.leaves.mshrs = chip.hardware_traverser_triangle_cache_mshrs;
  sizes.nodes.banks = sizes.leaves.banks = chip.hardware_traverser_cache_banks;
  sizes.pool = chip.ray_pool_size;
  sizes.record_words = configuration.intersection_words;
  sizes.contributes = chip.shading == Shading::Traverser;
  sizes.culling = chip.culling;
  sizes.miss_records = chip.miss_records;
  return sizes;
}

TraverserSetup traverser_setup(const FrameSetup& setup) {
  const TreeSetup& tree = setup.tree;
  return {tree.root,
          tree.bounds,
          {tree.triangles_line, tree.stacks_line, tree.triangle_lines},
          {tree.material_base, tree.layout, setup.depth, setup.reflections}};
}

class ChipModel : public ChipDevice {
 public:
  ChipModel(const Configuration& configuration, std::unique_ptr<ComputeUnit> device, PolicyMaker own_policy)
      : configuration_(configuration), own_policy_(std::move(own_policy)), device_(std::move(device)) {
    start({});
  }

  uint32_t units() const override { return device_->units(); }
  const ChipOutputs& outputs() const override { return out_; }
  uint64_t counter(int number) override { return device_->counter(number); }
  void open_waveform(const std::string& path) override { device_->open_waveform(path); }

  const Traverser* look_inside() {
    if (!blocks_->traverser) return nullptr;
    looks_inside_ = true;
    blocks_->traverser->look_inside();
    return &*blocks_->traverser;
  }
  Traverser* traverser() { return blocks_->traverser ? &*blocks_->traverser : nullptr; }

  ChipCounts counts() override {
    const Blocks& b = *blocks_;
    return {b.rays.taken(),   b.rays.busy_cycles(), b.intersections.taken(), b.frame.taken(),
            b.memory.reads(), b.memory.writes(),    b.memory.busy_cycles()};
  }

  std::optional<TraverserWork> traverser_work() const override {
    if (!blocks_->traverser) return {};
    return blocks_->traverser_used ? blocks_->traverser->work() : blocks_->traverser_work;
  }

  void start(const FrameSetup& setup) override {
    device_->reset(setup.program_length, setup.memory_limit);
    for (uint32_t index = 0; index < configuration_.arguments; ++index)
      device_->set_argument(index, setup.arguments[index]);
    blocks_ = std::make_unique<Blocks>(configuration_, device_->units(), own_policy_);
    setup_ = setup;
    cycle_ = 0;
    ready_ = starts_ = true;
    out_ = {};
    memory_changes_ = intersections_change_ = true;
    outcome_ = {};
    exported_valid_ = false;
    present();
  }

  void start_next(const FrameSetup& setup) override {
    check_next(setup_, setup, out_);
    setup_ = setup;
    for (uint32_t index = 0; index < configuration_.arguments; ++index)
      clock_around({}, [&] {
        device_->set_argument(index, setup.arguments[index]);
        return uint64_t{1};
      });
    starts_ = true;
  }

  void clock(const ChipInputs& inputs) override {
    clock_around(inputs, [this] {
      device_->clock(out_.to_device);
      return uint64_t{1};
    });
  }

  uint64_t run(const ChipInputs& inputs, uint64_t cycles) override {
    return clock_around(inputs, [&] {
      const uint64_t most = cycles == 1 ? 1 : std::min(cycles, still_for());
      return device_->run(out_.to_device, most);
    });
  }

 private:
  /// At the end of a cycle, before that of the units: cycles from this one on that pass until something happens outside
  /// the units, if they do not change what they show. A traverser inside has something in every cycle.
  uint64_t still_for() const {
    const Blocks& b = *blocks_;
    const UnitOutputs& device = out_.device;
    if (b.traverser || !out_.busy || outcome_.valid || exported_valid_ || !b.reader.still() || b.memory.offers() ||
        b.frame.valid() || device.frame_valid || b.rays.held_up(cycle_ + 1) != out_.held_up)
      return 1;
    uint64_t due =
        std::min({b.launches.due(cycle_ + 1, device.launch_ready), b.memory.start(), b.memory.response_due(),
                  b.memory.traverser_response_due(), b.intersections.beat_due(), b.intersections.request_due()});
    if (device.memory_request_valid) due = std::min(due, b.memory.room_from());
    if (device.export_valid) due = std::min(due, b.rays.beats_from());
    return due <= cycle_ ? 1 : due - cycle_;
  }

  // A cycle, and those in which only the units work; `clock_device` is what they are for these. Returns how many.
  template <typename ClockDevice>
  uint64_t clock_around(const ChipInputs& inputs, const ClockDevice& clock_device) {
    const TraverserPorts& outside = inputs;
    const bool starts = ready_ && (starts_ || inputs.start), idle = this->idle();
    if (starts) begin_frame();
    const TraverserPorts& traverser = blocks_->traverser ? out_.traverser : outside;
    clock_launch();
    clock_rays(traverser);
    clock_intersections(traverser);
    clock_memory(inputs, traverser);
    clock_frame(inputs, traverser);
    end_kernels();
    decide();
    clock_traverser();
    const uint64_t cycles = clock_device();
    ready_ = idle && !starts;
    starts_ = false;
    cycle_ += cycles;
    present();
    return cycles;
  }

  struct Blocks {
    Blocks(const Configuration& configuration, uint32_t units, const PolicyMaker& own_policy)
        : rays(configuration.chip, 0),
          reader(configuration.chip.ray_pool_size),
          intersections(configuration.chip, RecordLayout::in_order(configuration.intersection_words)),
          memory(configuration.chip, MemoryPort::Limits::of(configuration.chip)),
          launches(configuration, units, own_policy) {
      if (has_traverser(configuration.chip)) traverser.emplace(traverser_sizes(configuration));
    }

    RayPool rays;
    RayReader reader;
    IntersectionPool intersections;
    MemoryPort memory;
    FramePort frame;
    Launches launches;
    std::optional<Traverser> traverser;
    bool traverser_used = false;   // since its reset
    TraverserWork traverser_work;  // up to it
  };

  /// Nothing of a frame is left in the chip, as it stands in this cycle.
  bool idle() const {
    return !out_.busy && out_.device.idle && blocks_->memory.idle() && !out_.frame_valid &&
           !out_.traverser.tree_request_valid;
  }
  void begin_frame() {
    Blocks& b = *blocks_;
    b.rays.set_depth(setup_.depth);
    b.launches.begin(cycle_, setup_);
    if (b.traverser) b.traverser->set_up(traverser_setup(setup_));
  }

  // A launch is taken as soon as it is offered, by a unit that was ready before.
  void clock_launch() {
    Blocks& b = *blocks_;
    if (out_.to_device.launch_valid && out_.device.launch_ready) b.launches.accepted(cycle_, out_.device.launch_unit);
  }

  void clock_rays(const TraverserPorts& traverser) {
    Blocks& b = *blocks_;
    const UnitOutputs& device = out_.device;
    bool kept = false;
    outcome_.valid = false;
    if (device.export_valid) {
      if (!out_.to_device.export_ready) {
        b.rays.want(cycle_);
      } else if (b.rays.take(cycle_, device.export_data)) {
        const RayPool::Outcome& outcome = b.rays.outcome();
        const Ray& ray = b.rays.ray();
        kept = outcome.kept;
        outcome_ = {true,
                    kept,
                    outcome.deep,
                    outcome.shadow,
                    !outcome.shadow && (ray[word::kFlags] & kDepthMask) == 1,
                    device.export_unit,
                    ray[word::kPixel]};
        b.launches.ray_left(cycle_, device.export_unit, outcome.shadow);
      }
    }
    if (traverser.free_valid) {
      b.rays.free(cycle_, traverser.free_place, traverser.free_shadow);
      b.launches.changed();
    }
    b.reader.clock(traverser.ray_ready);
    if (kept) b.reader.push(b.rays.outcome().place, b.rays.ray());
  }

  void clock_intersections(const TraverserPorts& traverser) {
    Blocks& b = *blocks_;
    if (out_.device.import_request_valid &&
        b.intersections.request(cycle_, out_.device.import_request_kind, out_.device.import_request_unit))
      intersections_change_ = true;
    if (traverser.put_valid && (out_.put_ready >> to_underlying(traverser.put_kind) & 1) != 0) {
      b.intersections.put_beat(cycle_, traverser.put_kind, traverser.put_data);
      intersections_change_ = true;
    }
    if (out_.reserve_valid) {
      b.intersections.reserve(out_.reserve_kind, out_.reserve_count);
      intersections_change_ = true;
    }
    if (intersections_change_) b.launches.changed();
  }

  void clock_memory(const ChipInputs& inputs, const TraverserPorts& traverser) {
    MemoryPort& memory = blocks_->memory;
    const auto happens = [this](bool event) {
      memory_changes_ = memory_changes_ || event;
      return event;
    };
    if (happens(out_.memory_request_valid && inputs.memory_request_ready)) memory.taken(cycle_);
    if (happens(out_.device.memory_request_valid && out_.to_device.memory_request_ready))
      memory.request(cycle_, out_.device.memory_request);
    if (happens(traverser.tree_request_valid && out_.tree_request_ready))
      memory.request(cycle_, traverser.tree_request);
    if (happens(memory.start() <= cycle_)) memory.serve(cycle_);
    if (happens(out_.to_device.memory_response_valid)) memory.response();
    if (happens(out_.tree_response_valid)) memory.traverser_response();
    if (happens(inputs.memory_beat_valid && out_.memory_beat_ready)) memory.beat(cycle_, inputs.memory_beat_data);
  }

  void clock_frame(const ChipInputs& inputs, const TraverserPorts& traverser) {
    FramePort& frame = blocks_->frame;
    exported_valid_ = out_.device.frame_valid && out_.to_device.frame_ready;
    if (exported_valid_) {
      frame.take(cycle_, out_.device.frame);
      exported_unit_ = out_.device.frame_unit;
      exported_pixel_ = out_.device.frame.pixel;
      blocks_->launches.contribution_left(cycle_, exported_unit_);
    }
    if (traverser.contribution_valid && out_.contribution_ready) frame.take(cycle_, traverser.contribution);
    if (out_.frame_valid && inputs.frame_ready) frame.leave();
  }

  // Between two frames it is in reset.
  void clock_traverser() {
    if (!blocks_->traverser) return;
    if (ready_) {
      if (!blocks_->traverser_used) return;
      blocks_->traverser_work = blocks_->traverser->work();
      blocks_->traverser.emplace(traverser_sizes(configuration_));
      blocks_->traverser->set_up(traverser_setup(setup_));
      if (looks_inside_) blocks_->traverser->look_inside();
      blocks_->traverser_used = false;
      return;
    }
    blocks_->traverser_used = true;
    Traverser::Inputs in{};
    in.ray_valid = out_.ray_valid;
    in.ray_last = out_.ray_last;
    in.ray_place = out_.ray_place;
    in.ray_data = out_.ray_data;
    in.put_ready = out_.put_ready;
    in.contribution_ready = out_.contribution_ready;
    in.request_ready = out_.tree_request_ready;
    in.response_valid = out_.tree_response_valid;
    in.response_beat = out_.tree_response_beat;
    in.response_data = out_.tree_response_data;
    blocks_->traverser->clock(in);
  }

  void end_kernels() {
    for (uint32_t done = out_.device.kernel_done; done != 0; done &= done - 1) {
      const uint32_t unit = lowest(done);
      blocks_->launches.kernel_ended(cycle_, unit, out_.device.exports[unit]);
    }
  }

  void decide() {
    Blocks& b = *blocks_;
    if (!b.launches.looks(cycle_, out_.device.launch_ready)) return;
    Controller::Levels levels;
    levels.ready = out_.device.launch_ready;
    levels.rays = b.rays.size();
    levels.shadow_rays = b.rays.shadow_rays();
    for (const ImportKind kind : kKinds) {
      levels.size[kind] = b.intersections.size(kind);
      levels.available[kind] = b.intersections.available(kind);
    }
    b.launches.decide(cycle_, levels);
  }

  // What the ports show in the cycle that begins.
  void present() {
    out_.device = device_->outputs();
    out_.ready = ready_;
    present_launch();
    present_rays();
    present_intersections();
    present_memory();
    present_frame();
    present_traverser();
  }

  void present_launch() {
    Launches& launches = blocks_->launches;
    UnitInputs& to_device = out_.to_device;
    out_.busy = launches.busy(cycle_);
    const bool was_valid = to_device.launch_valid;
    to_device.launch_valid = launches.offered(cycle_);
    if (to_device.launch_valid && !was_valid) to_device.launch = launches.command(cycle_);
    out_.reserve_valid = launches.reserves(cycle_);
    if (!out_.reserve_valid) return;
    out_.reserve_kind = launches.import();
    out_.reserve_count = launches.threads();
  }

  void present_rays() {
    const Blocks& b = *blocks_;
    out_.to_device.export_ready = b.rays.beats_from() <= cycle_;
    out_.outcome = outcome_;
    out_.rays = b.rays.size();
    out_.shadow_rays = b.rays.shadow_rays();
    out_.held_up = out_.device.export_valid && b.rays.held_up(cycle_);
    out_.ray_valid = b.reader.valid();
    if (!out_.ray_valid) return;
    out_.ray_last = b.reader.last();
    out_.ray_place = b.reader.place();
    out_.ray_data = b.reader.data();
  }

  void present_intersections() {
    IntersectionPool& pool = blocks_->intersections;
    UnitInputs& to_device = out_.to_device;
    if (intersections_change_) present_levels();
    to_device.import_request_ready = pool.request_due() == cycle_;
    to_device.import_beat_valid = pool.beat_due() == cycle_;
    out_.pixel_valid = false;
    if (!to_device.import_beat_valid) return;
    out_.pixel_valid = pool.beat_number() == word::kPixel / kBeatWords;
    out_.pixel_unit = static_cast<uint8_t>(pool.beat_unit());
    pool.beat(to_device.import_beat);
  }

  void present_levels() {
    const IntersectionPool& pool = blocks_->intersections;
    out_.put_ready = 0;
    for (const ImportKind kind : kKinds) {
      out_.size[kind] = pool.size(kind);
      out_.available[kind] = pool.available(kind);
      if (kind != ImportKind::Direct || configuration_.chip.culling)
        out_.put_ready |= uint32_t{pool.put_ready(kind)} << to_underlying(kind);
    }
    intersections_change_ = false;
  }

  void present_memory() {
    const MemoryPort& memory = blocks_->memory;
    UnitInputs& to_device = out_.to_device;
    to_device.memory_request_ready = memory.room_from() <= cycle_;
    to_device.memory_response_valid = memory.response_due() == cycle_;
    if (to_device.memory_response_valid) to_device.memory_response = memory.next_response();
    out_.tree_response_valid = memory.traverser_response_due() == cycle_;
    if (out_.tree_response_valid) {
      out_.tree_response_beat = memory.next_traverser_response().beat;
      out_.tree_response_data = memory.next_traverser_response().data;
    }
    if (!memory_changes_) return;
    memory_changes_ = false;
    out_.tree_request_ready = memory.traverser_room();
    out_.memory_beat_ready = memory.beat_ready();
    out_.memory_request_valid = memory.offers();
    if (out_.memory_request_valid) out_.memory_request = memory.access();
    out_.quiet = 0;
    for (uint32_t unit = 0; unit < device_->units(); ++unit)
      out_.quiet |= uint32_t{memory.quiet(cycle_ - 1, unit)} << unit;
  }

  void present_frame() {
    const FramePort& frame = blocks_->frame;
    out_.to_device.frame_ready = frame.room();
    out_.contribution_ready = frame.room() && !out_.device.frame_valid;
    out_.frame_valid = frame.valid();
    if (out_.frame_valid) out_.frame = frame.data();
    out_.exported_valid = exported_valid_;
    out_.exported_unit = exported_unit_;
    out_.exported_pixel = exported_pixel_;
  }

  void present_traverser() {
    if (!blocks_->traverser) return;
    const Traverser::Outputs& shown = blocks_->traverser->outputs();
    TraverserPorts& ports = out_.traverser;
    ports.ray_ready = shown.ray_ready;
    ports.free_valid = shown.free_valid;
    ports.free_place = shown.free_place;
    ports.free_shadow = shown.free_shadow;
    ports.put_valid = shown.put_valid;
    ports.put_kind = shown.put_kind;
    if (shown.put_valid) ports.put_data = shown.put_data;
    ports.contribution_valid = shown.contribution_valid;
    if (shown.contribution_valid) ports.contribution = shown.contribution;
    ports.tree_request_valid = shown.request_valid && !ready_;
    if (ports.tree_request_valid) ports.tree_request = shown.request;
    out_.nodes_given = shown.nodes_given;
    out_.leaves_given = shown.leaves_given;
    out_.tree_fault = shown.fault;
  }

  Configuration configuration_;
  PolicyMaker own_policy_;
  std::unique_ptr<ComputeUnit> device_;
  std::unique_ptr<Blocks> blocks_;  // since the reset
  FrameSetup setup_;
  bool ready_ = true;    // for a frame
  bool starts_ = false;  // one begins in the next cycle that is clocked
  bool looks_inside_ = false;
  bool memory_changes_ = true, intersections_change_ = true;  // in this cycle, what their ports show of their levels
  uint64_t cycle_ = 0;                                        // since the reset
  ChipOutputs out_;
  ChipOutputs::Outcome outcome_;  // of the cycle before, as are these
  bool exported_valid_ = false;
  uint8_t exported_unit_ = 0;
  uint32_t exported_pixel_ = 0;
};

}  // namespace

const Traverser* look_inside_traverser(ChipDevice& chip) {
  auto* model = dynamic_cast<ChipModel*>(&chip);
  return model == nullptr ? nullptr : model->look_inside();
}

void remember_lines(ChipDevice& chip, const TreeLines& lines, const std::function<TreeLine(uint32_t line)>& read) {
  auto* model = dynamic_cast<ChipModel*>(&chip);
  Traverser* const traverser = model == nullptr ? nullptr : model->traverser();
  if (traverser == nullptr) throw std::logic_error("only the model of a chip with a traverser inside remembers lines");
  traverser->remember(lines, read);
}

std::unique_ptr<ChipDevice> make_chip_model(const Configuration& configuration, std::unique_ptr<ComputeUnit> device,
                                            PolicyMaker own_policy) {
  return std::make_unique<ChipModel>(configuration, std::move(device), std::move(own_policy));
}

}  // namespace raypool
