#include "cosim/chip_recorder.hpp"

#include "bits.hpp"
#include "cosim/bus.hpp"
#include "machine/common/packages.hpp"

namespace raypool {
namespace {

constexpr uint32_t kAll = ~uint32_t{0};

/// What stays for a frame.
void put_setup(Bus& bus, const FrameSetup& setup) {
  bus.put(setup.program_length, 16);
  bus.put(setup.memory_limit, 32);
  bus.put(setup.width, 16);
  bus.put(setup.height, 16);
  bus.put(setup.depth, 8);
  bus.put(setup.reflections ? 1 : 0, 1);
  for (const RayKernel kernel :
       {RayKernel::CastEye, RayKernel::CastSecondary, RayKernel::CastSecondaryDirect, RayKernel::Shade})
    bus.put(setup.entries[kernel], 16);
  const TreeSetup& tree = setup.tree;
  bus.put(tree.root, 32);
  for (const auto* corner : {&tree.bounds.lower, &tree.bounds.upper})
    for (size_t axis = 3; axis-- > 0;) bus.put(as_bits((*corner)[axis]), 32);
  bus.put(tree.triangles_line, 26);
  bus.put(tree.triangle_lines, 26);
  bus.put(tree.stacks_line, 26);
  bus.put(tree.material_base, 32);
  const auto words = words_of(tree.layout);
  for (size_t place = words.size(); place-- > 0;) bus.put(words[place], 5);
}

/// Of one at the chip's ports.
void put_traverser(Bus& bus, const TraverserPorts& in, int place_bits) {
  bus.put(in.ray_ready ? 1 : 0, 1);
  bus.put(in.free_valid ? 1 : 0, 1);
  bus.put(in.free_place, place_bits);
  bus.put(in.free_shadow ? 1 : 0, 1);
  bus.put(in.put_valid ? 1 : 0, 1);
  bus.put(to_underlying(in.put_kind), 2);
  bus.put_words(in.put_data);
  bus.put(in.contribution_valid ? 1 : 0, 1);
  bus.put(in.contribution.pixel, 32);
  bus.put_words(in.contribution.rgb);
  bus.put(in.tree_request_valid ? 1 : 0, 1);
  bus.put(in.tree_request.write ? 1 : 0, 1);
  bus.put(in.tree_request.second ? 1 : 0, 1);
  bus.put(in.tree_request.address, 32);
  bus.put_words(in.tree_request.data[1]);
  bus.put_words(in.tree_request.data[0]);
}

void expect_chip(ExpectedBus& bus, const ChipOutputs& out, int kinds, int place_bits, bool on) {
  bus.put(out.ready ? 1 : 0, 1, on);
  bus.put(out.busy ? 1 : 0, 1, on);
  const MemoryRequest& request = out.memory_request.request;
  const bool asks = on && out.memory_request_valid, writes = asks && request.write;
  bus.put(out.memory_request_valid ? 1 : 0, 1, on);
  bus.put(out.memory_request.traverser ? 1 : 0, 1, asks);
  bus.put(request.write ? 1 : 0, 1, asks);
  bus.put(request.address, 32, asks);
  bus.put_words(request.data, writes ? request.mask : 0);
  bus.put(request.mask, 4, writes);
  bus.put(out.memory_beat_ready ? 1 : 0, 1, on);
  const bool frame = on && out.frame_valid;
  bus.put(out.frame_valid ? 1 : 0, 1, on);
  bus.put(out.frame.pixel, 32, frame);
  bus.put_words(out.frame.rgb, frame ? kAll : 0);
  const bool ray = on && out.ray_valid;
  bus.put(out.ray_valid ? 1 : 0, 1, on);
  bus.put(out.ray_last ? 1 : 0, 1, ray);
  bus.put(out.ray_place, place_bits, ray);
  bus.put_words(out.ray_data, ray ? kAll : 0);
  bus.put(out.put_ready >> to_underlying(ImportKind::Normal), kinds, on);
  bus.put(out.contribution_ready ? 1 : 0, 1, on);
  bus.put(out.tree_request_ready ? 1 : 0, 1, on);
  const bool response = on && out.tree_response_valid;
  bus.put(out.tree_response_valid ? 1 : 0, 1, on);
  bus.put(out.tree_response_beat, 2, response);
  bus.put_words(out.tree_response_data, response ? kAll : 0);
}

void expect_units(ExpectedBus& bus, const UnitOutputs& out, bool on) {
  bus.put(out.import_request_valid ? 1 : 0, 1, on);
  bus.put(to_underlying(out.import_request_kind), 2, on && out.import_request_valid);
  bus.put(out.import_request_unit, 2, on && out.import_request_valid);
  const bool exported = on && out.export_valid;
  bus.put(out.export_valid ? 1 : 0, 1, on);
  bus.put(out.export_last ? 1 : 0, 1, exported);
  bus.put(out.export_unit, 2, exported);
  bus.put_words(out.export_data, exported ? kAll : 0);
  bus.put(out.fault.code != FaultCode::None ? 1 : 0, 1, on);
}

/// Of one inside.
void expect_traverser(ExpectedBus& bus, const ChipOutputs& chip, int place_bits, bool on) {
  const TraverserPorts& out = chip.traverser;
  bus.put(out.ray_ready ? 1 : 0, 1, on);
  bus.put(out.free_valid ? 1 : 0, 1, on);
  bus.put(out.free_place, place_bits, on && out.free_valid);
  bus.put(out.free_shadow ? 1 : 0, 1, on && out.free_valid);
  bus.put(out.put_valid ? 1 : 0, 1, on);
  bus.put(to_underlying(out.put_kind), 2, on && out.put_valid);
  bus.put_words(out.put_data, on && out.put_valid ? kAll : 0);
  const bool contribution = on && out.contribution_valid;
  bus.put(out.contribution_valid ? 1 : 0, 1, on);
  bus.put(out.contribution.pixel, 32, contribution);
  bus.put_words(out.contribution.rgb, contribution ? kAll : 0);
  const TreeRequest& request = out.tree_request;
  const bool asks = on && out.tree_request_valid, writes = asks && request.write;
  bus.put(out.tree_request_valid ? 1 : 0, 1, on);
  bus.put(request.write ? 1 : 0, 1, asks);
  bus.put(request.second ? 1 : 0, 1, asks);
  bus.put(request.address, 32, asks);
  bus.put_words(request.data[1], writes && request.second ? kAll : 0);
  bus.put_words(request.data[0], writes ? kAll : 0);
  bus.put(chip.tree_fault.valid ? 1 : 0, 1, on);
  bus.put(to_underlying(chip.tree_fault.code), 3, on && chip.tree_fault.valid);
  bus.put(chip.tree_fault.line, 26, on && chip.tree_fault.valid);
}

}  // namespace

ChipRecorder::ChipRecorder(const Configuration& configuration, ChipDevice& chip, std::ostream& out)
    : chip_(chip),
      out_(out),
      arguments_(configuration.arguments),
      kinds_(configuration.chip.culling ? 3 : 2),
      place_bits_(1),
      inside_(has_traverser(configuration.chip)) {
  while ((uint32_t{1} << place_bits_) < configuration.chip.ray_pool_size) ++place_bits_;
}

void ChipRecorder::start(const FrameSetup& setup) {
  chip_.start(setup);
  setup_ = setup;
  // Nothing is compared before the frame begins.
  for (int cycle = 0; cycle < 4; ++cycle) record({true, false, false, 0, 0}, {}, false);
  record({}, {}, false);
  record_arguments();
}

void ChipRecorder::start_next(const FrameSetup& setup) {
  chip_.start_next(setup);
  setup_ = setup;
  record_arguments();
}

void ChipRecorder::record_arguments() {
  for (uint32_t index = 0; index < arguments_; ++index)
    record({false, false, true, index, setup_.arguments[index]}, {}, false);
  starts_ = true;
}

void ChipRecorder::clock(const ChipInputs& inputs) {
  record({false, starts_ || inputs.start, false, 0, 0}, inputs, true);
  starts_ = false;
  chip_.clock(inputs);
}

void ChipRecorder::record(const Host& host, const ChipInputs& inputs, bool checked) {
  Bus in;
  in.put(host.reset ? 0 : 1, 1);
  put_setup(in, setup_);
  in.put(host.start ? 1 : 0, 1);
  in.put(host.argument ? 1 : 0, 1);
  in.put(host.index, 5);
  in.put(host.value, 32);
  in.put(inputs.memory_request_ready ? 1 : 0, 1);
  in.put(inputs.memory_beat_valid ? 1 : 0, 1);
  in.put_words(inputs.memory_beat_data);
  in.put(inputs.frame_ready ? 1 : 0, 1);
  put_traverser(in, inputs, place_bits_);
  ExpectedBus expected;
  const ChipOutputs& out = chip_.outputs();
  expect_chip(expected, out, kinds_, place_bits_, checked);
  expect_units(expected, out.device, checked);
  expect_traverser(expected, out, place_bits_, checked && inside_);
  out_ << in.hex() << ' ' << expected.hex() << '\n';
}

}  // namespace raypool
