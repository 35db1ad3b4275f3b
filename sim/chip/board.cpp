#include "chip/board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "bits.hpp"
#include "chip/frame_setup.hpp"
#include "chip/traverser_fault.hpp"
#include "config/limits.hpp"
#include "machine/chip/chip_model.hpp"
#include "machine/chip/intersection_pool.hpp"
#include "scene/native_renderer.hpp"

namespace raypool {

namespace chip {

namespace {

const ChipOptions& checked(const ChipOptions& options) {
  check_frame(options);
  const ChipConfiguration& chip = options.configuration.chip;
  if (has_traverser(chip) && options.traverser != nullptr) {
    throw InputError(
        "the chip has its traverser inside, and no ports for another: draw with --traverser static for one of your "
        "own");
  }
  if (has_traverser(chip) ? options.tree == nullptr : options.tracer == nullptr && options.traverser == nullptr)
    throw std::logic_error("a traverser needs its memory, or a tracer");
  check_memory_latency(chip);
  return options;
}

}  // namespace

Board::Board(const ChipOptions& options, ChipDevice& chip, LineStore& store, FrameBegin begin)
    : Board(checked(options), frame_setup(options), chip, store, begin) {}

Board::Board(const ChipOptions& options, const FrameSetup& setup, ChipDevice& chip, LineStore& store, FrameBegin begin)
    : options_(checked(options)),
      chip_(chip),
      setup_(setup),
      memory_(store, options.configuration.chip),
      answers_(options.configuration.chip),
      kernels_(chip.units(), options.configuration.contents()),
      progress_(options.watchdog_cycles, options.limits.silent()),
      last_counted_(options.timed ? counted_cycles(options.configuration) : kNever),
      look_at_(options.watchdog_cycles == 0 ? kNever : 0) {
  const ChipConfiguration& configuration = options.configuration.chip;
  if (has_traverser(configuration)) {
    watch_.emplace(options.layout, configuration.ray_pool_size, options.depth);
  } else {
    external_ = options.traverser;
    if (external_ == nullptr)
      external_ = &static_traverser_.emplace(*options.tracer, configuration, chip.units(), options.layout);
    external_->start(setup_);
  }
  if (begin == FrameBegin::Reset) {
    chip_.start(setup_);
  } else {
    chip_.start_next(setup_);
    counts_before_ = chip_.counts();
    for (int number = 0; number < counter::kCount; ++number) counters_before_[number] = chip_.counter(number);
  }
  if (options.tile_costs != nullptr) tiles_.emplace(options, chip.units(), chip.outputs(), [this] { return counts(); });
}

ChipResult Board::result() {
  if (options_.progress) show_progress();
  if (tiles_) tiles_->end();
  return chip_result(options_, figures());
}

uint64_t Board::clock(uint64_t most) {
  const ChipOutputs& outputs = chip_.outputs();
  if (outputs.device.fault.code != FaultCode::None) {
    const Fault& fault = outputs.device.fault;
    throw ChipFault(fault.unit, fault, fault_sentence(fault.unit, fault));
  }
  if (outputs.tree_fault.valid)
    throw TraverserFault(outputs.tree_fault, fault_sentence(outputs.tree_fault, setup_.tree));
  begun_ |= outputs.busy;
  if (begun_ && !ended_ && !outputs.busy) {
    ended_ = true;
    cycles_ = cycle_;
  }
  const bool moves = outputs.frame_valid || !outputs.device.idle || outputs.quiet + 1 != 1u << chip_.units();
  still_ = ended_ && !moves ? still_ + 1 : 0;
  memory_.offer(cycle_, inputs_);
  inputs_.frame_ready = options_.frame->ready();
  if (external_ != nullptr) external_->offer(inputs_);

  if (!ended_) {
    follow_kernels(outputs);
    follow_levels(outputs);
    count_work(outputs);
    if (cycle_ == watch_at_) watch();
    if (answers_.clock(cycle_, outputs, inputs_)) throw ChipStalled(at_cycle(answers_.late()) + "; " + state());
  }
  if (tiles_) tiles_->clock(outputs, watch_ ? outputs.traverser : inputs_);
  if (outputs.frame_valid && inputs_.frame_ready) options_.frame->add(outputs.frame);
  memory_.clock(cycle_, outputs, inputs_);
  const bool stalls = kernels_.under_way() == 0 || outputs.held_up;
  if (external_ != nullptr) external_->clock(outputs, inputs_, stalls);
  if (watch_) watch_->clock(outputs);
  const uint32_t busy = popcount(outputs.device.busy);
  const uint64_t cycles = chip_.run(inputs_, std::min(most, still_for(stalls)));
  ++cycle_;
  if (cycles == 1) return 1;
  stay(cycles - 1, stalls, busy);
  cycle_ += cycles - 1;
  return cycles;
}

// Before chip_.run(): cycles that it may take.
uint64_t Board::still_for(bool stalls) const {
  if (external_ == nullptr || ended_) return 1;
  const uint64_t still = external_->still_for(stalls);
  const uint64_t due = std::min({memory_.due(), answers_.due(), watch_at_});
  return due <= cycle_ ? 1 : std::min(still, due - cycle_ - 1) + 1;
}

// After it: what is counted in each cycle. Levels are those that the second of them has begun with.
void Board::stay(uint64_t cycles, bool stalls, uint32_t busy) {
  external_->stay(cycles, stalls);
  busy_cycles_ += cycles * busy;
  follow_levels(chip_.outputs());
}

RayKernel Board::kernel_at(uint32_t pc) const {
  const auto entry = std::find(options_.entries.begin(), options_.entries.end(), pc);
  if (entry == options_.entries.end())
    throw std::logic_error(fmt::format("the chip launches a kernel at PC {}, where none begins", pc));
  return static_cast<RayKernel>(entry - options_.entries.begin());
}

void Board::follow_kernels(const ChipOutputs& outputs) {
  for (uint32_t done = outputs.device.kernel_done; done != 0; done &= done - 1) kernels_.ended(lowest(done), cycle_);
  busy_cycles_ += popcount(outputs.device.busy);
  if (!outputs.to_device.launch_valid || !outputs.device.launch_ready) return;
  const LaunchCommand& launch = outputs.to_device.launch;
  const uint32_t unit = outputs.device.launch_unit;
  const RayKernel kernel = kernel_at(launch.pc);
  kernels_.given(unit, kernel, launch.threads);
  kernels_.accepted(unit, cycle_);
  if (kernel == RayKernel::CastEye) cast_ += launch.threads;
  if (tiles_ && tiles_->launched(unit, kernel, launch) && options_.visited_before && watch_) remember(tiles_->number());
}

void Board::remember(uint32_t tile) {
  remember_lines(chip_, lines_of(options_.visited_before(tile)), [this](uint32_t line) {
    TreeLine data;
    uint32_t address = raypool::MemoryLine::kBytes * line;
    for (uint32_t& word : data) word = options_.tree->memory.load(address), address += 4;
    return data;
  });
}

uint64_t Board::intersection_port_busy(const ChipCounts& counts) const {
  return counts.packages_taken *
         raypool::IntersectionPool::service_cycles(options_.configuration.chip, options_.layout.words);
}

Counts Board::counts() const {
  Counts counts{};
  const RayCounts& rays = traced().rays;
  const ChipCounts chip = chip_.counts() - counts_before_;
  const auto set = [&](size_t number, uint64_t value) { counts[number] = static_cast<double>(value); };
  set(count::kCycles, ended_ ? cycles_ : cycle_);
  set(count::kEyeRays, rays.eye.traced);
  set(count::kReflectionRays, rays.reflection.traced);
  set(count::kShadowRays, rays.shadow.traced);
  set(count::kBusyCycles, counter(counter::kBusyCycles));
  set(count::kInstructions, counter(counter::kInstructions));
  set(count::kThreadInstructions, counter(counter::kThreadInstructions));
  set(count::kRayPort, chip.ray_port_busy);
  set(count::kIntersectionPort, intersection_port_busy(chip));
  set(count::kMemoryPort, chip.memory_port_busy);
  for (size_t type = 0; type < kAluTypes; ++type) {
    set(count::kUnused + type, counter(counter::kUnused + static_cast<int>(type)));
    set(count::kIssued + type, counter(counter::kIssued + static_cast<int>(type)));
  }
  return counts;
}

void Board::follow_levels(const ChipOutputs& outputs) {
  rays_.set(cycle_, outputs.rays);
  intersections_[ImportKind::Normal].set(cycle_, outputs.size[ImportKind::Normal]);
  intersections_[ImportKind::Shadow].set(cycle_, outputs.size[ImportKind::Shadow]);
  intersections_[ImportKind::Direct].set(cycle_, outputs.size[ImportKind::Direct]);
  dropped_depth_ += outputs.outcome.valid && outputs.outcome.deep;
}

// A traverser inside may test for long without a transfer at its ports. Where only these can be seen it is taken for
// one that does while it has rays.
void Board::count_work(const ChipOutputs& outputs) {
  const TraverserPorts& traverser = watch_ ? outputs.traverser : inputs_;
  const UnitInputs& to_device = outputs.to_device;
  const bool unseen = outputs.nodes_given == ChipOutputs::kNotSeen;
  work_ += (outputs.memory_request_valid && inputs_.memory_request_ready) +
           (inputs_.memory_beat_valid && outputs.memory_beat_ready) + (outputs.ray_valid && traverser.ray_ready) +
           traverser.free_valid + (outputs.frame_valid && inputs_.frame_ready) +
           (to_device.launch_valid && outputs.device.launch_ready) + to_device.import_beat_valid +
           (outputs.device.export_valid && to_device.export_ready) + outputs.outcome.valid + outputs.pixel_valid +
           (unseen ? outputs.rays != 0 : (outputs.nodes_given | outputs.leaves_given) != 0);
}

uint64_t Board::due() const {
  const uint64_t stall = external_ != nullptr ? external_->stall_left() : 0;
  // A line that is due in this cycle comes in it, which is later than what has been counted.
  return std::min(std::max(memory_.due(), cycle_ + 1), stall == 0 ? kNever : cycle_ + stall);
}

// The next cycle behind this one in which watch() has something to look at.
uint64_t Board::next_watch() const {
  uint64_t next = std::min(look_at_, last_counted_);
  if (options_.limits.cycles > cycle_) next = std::min(next, options_.limits.cycles);
  if (options_.progress) next = std::min(next, (cycle_ / kProgressCycles + 1) * kProgressCycles);
  return next;
}

void Board::watch() {
  if (options_.progress && cycle_ % kProgressCycles == 0) show_progress();
  if (options_.limits.cycles != 0 && cycle_ == options_.limits.cycles)
    throw LimitPassed(at_cycle(limit_sentence(options_.limits.cycles, true)), state());
  if (cycle_ == last_counted_) {
    throw InputError(
        fmt::format("{} cycles have passed, and after so many a performance counter of {}, of {} bits, may "
                    "have wrapped: draw with --set counter_bits=48",
                    cycle_, options_.configuration.name, options_.configuration.counter_bits));
  }
  const bool looks = cycle_ == look_at_;
  if (looks) look_at_ += options_.watchdog_cycles;
  watch_at_ = next_watch();
  if (!looks) return;
  switch (progress_.look(cycle_, {chip_.counter(counter::kInstructions), work_, due()})) {
    case ProgressWatch::State::GoesOn:
      break;
    case ProgressWatch::State::LockedUp:
      throw ChipStalled(at_cycle(progress_.locked_up()) + "; " + state());
    case ProgressWatch::State::Silent:
      throw LimitPassed(at_cycle(progress_.silent()), state());
  }
}

std::string Board::at_cycle(const std::string& what) const { return fmt::format("{}, at cycle {}", what, cycle_); }

std::string Board::state() const {
  const ChipOutputs& o = chip_.outputs();
  const ChipConfiguration& chip = options_.configuration.chip;
  const TraverserPorts& traverser = watch_ ? o.traverser : inputs_;
  std::string waits;
  const auto add = [&](bool shown, const std::string& what) {
    if (shown) waits += what + "; ";
  };
  for (uint32_t unit = 0; unit < chip_.units(); ++unit) {
    const bool busy = (o.device.busy >> unit & 1) != 0, quiet = (o.quiet >> unit & 1) != 0;
    add(busy || !quiet, fmt::format("unit {} {}{}", unit, busy ? "runs a kernel" : "has none",
                                    quiet ? "" : " and waits for the memory port"));
  }
  add(o.device.export_valid && !o.to_device.export_ready,
      fmt::format("unit {} waits for the ray pool to take a ray", o.device.export_unit));
  add(o.device.import_request_valid && !o.to_device.import_request_ready,
      fmt::format("unit {} waits for the intersection pool to give it a package", o.device.import_request_unit));
  add(o.device.memory_request_valid && !o.to_device.memory_request_ready,
      "a unit's request waits for the memory port: its queue is full");
  add(o.to_device.launch_valid && !o.device.launch_ready, "the controller waits for a unit that takes a kernel");
  const bool waits_for_rays =
      cast_ >= uint64_t{options_.width} * options_.height &&
      o.available[ImportKind::Normal] + o.available[ImportKind::Shadow] + o.available[ImportKind::Direct] == 0;
  add(!o.to_device.launch_valid && o.device.launch_ready,
      waits_for_rays
          ? "the controller has nothing to launch until intersections come"
          : fmt::format("the controller launches nothing, though unit {} could take a kernel", o.device.launch_unit));
  add(o.ray_valid && !traverser.ray_ready, "a ray waits for the traverser to take it");
  add(traverser.put_valid && (o.put_ready >> to_underlying(traverser.put_kind) & 1) == 0,
      "the traverser waits for room in the intersection pool");
  add(traverser.contribution_valid && !o.contribution_ready, "the traverser waits for the frame port");
  add(traverser.tree_request_valid && !o.tree_request_ready, "the traverser waits for the memory port");
  add(o.frame_valid && !inputs_.frame_ready, "a contribution waits for the frame buffer");
  add(o.memory_request_valid && !inputs_.memory_request_ready, "the memory port waits for the memory");
  if (const std::optional<std::string> lines = answers_.waits()) add(true, *lines);
  add(external_ != nullptr, external_ != nullptr ? external_->describe() : "");
  return fmt::format(
      "{}{} kernels under way; ray pool {} of {} rays{}, {} of them shadow rays; intersection pool {} normal, "
      "{} shadow and {} direct of {} each; {} pixels of {}x{} have been cast",
      waits, kernels_.under_way(), o.rays, chip.ray_pool_size, o.rays == chip.ray_pool_size ? ", which is full" : "",
      o.shadow_rays, o.size[ImportKind::Normal], o.size[ImportKind::Shadow], o.size[ImportKind::Direct],
      chip.intersection_pool_size, cast_, options_.width, options_.height);
}

// Of the pixels that are cast: which of them are finished cannot be seen from outside.
void Board::show_progress() const {
  const double pixels = static_cast<double>(options_.width) * options_.height;
  options_.progress({ended_ ? 1 : std::min(1.0, static_cast<double>(cast_) / pixels), ended_ ? cycles_ : cycle_,
                     traced().rays.traced()});
}

uint64_t Board::counter(int number) const {
  const uint64_t all = (uint64_t{1} << options_.configuration.counter_bits) - 1;
  return (chip_.counter(number) - counters_before_[number]) & all;
}

FrameFigures Board::figures() {
  const ChipCounts counts = chip_.counts() - counts_before_;
  FrameFigures figures;
  figures.timed = options_.timed;
  figures.cycles = cycles_;
  figures.units = chip_.units();
  figures.counter = [this](int number) { return counter(number); };
  figures.kernels = &kernels_;
  figures.busy_cycles = busy_cycles_;
  figures.rays = &rays_;
  for (size_t kind = 0; kind < kImportKinds; ++kind) figures.intersections[kind] = &intersections_[kind];
  figures.dropped_depth = dropped_depth_;
  figures.contributions = counts.contributions;
  figures.ray_port_busy = counts.ray_port_busy;
  figures.intersection_port_busy = intersection_port_busy(counts);
  figures.memory_port_busy = counts.memory_port_busy;
  figures.memory_reads = counts.memory_reads;
  figures.memory_writes = counts.memory_writes;
  figures.traverser = traced();
  figures.work = chip_.traverser_work();
  return figures;
}

}  // namespace chip

std::unique_ptr<ChipDevice> make_chip_around(ChipOptions& options, std::unique_ptr<ComputeUnit> device) {
  options.timed = device->timed();
  if (!options.timed) options.configuration.chip.traverser = TraverserName::Static;
  return make_chip_model(options.configuration, std::move(device));
}

ChipResult run_board(const ChipOptions& options, ChipDevice& chip, FrameBegin begin) {
  const auto begun = std::chrono::steady_clock::now();
  chip::FixedLatencyStore store(*options.memory, options.tree == nullptr ? nullptr : &options.tree->memory,
                                options.configuration.chip);
  chip::Board board(options, chip, store, begin);
  while (!board.ended()) board.clock();
  ChipResult result = board.result();
  result.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return result;
}

}  // namespace raypool
