// What is said to be looked at by nothing changes no frame.
#include "config/unused_fields.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "chip/test_board.hpp"
#include "config/settings.hpp"

namespace raypool {
namespace {

/// A frame of 8x8 pixels on this machine: in SystemC, or on a board.
std::pair<uint64_t, FrameBuffer> drawn(const Configuration& configuration, bool on_board) {
  test::RealFrame run(configuration.warps, configuration.lanes, 8, 8, 2);
  run.options.configuration = configuration;
  std::optional<TreeImage> tree;
  if (!on_board) {
    run.set_device(make_model(configuration, run.image.memory, 1).device);
    const uint64_t cycles = run_chip(run.options).cycles;
    return {cycles, run.frame};
  }
  run.options.configuration.chip.controller = ControllerName::Counters;
  if (has_traverser(configuration.chip)) {
    tree.emplace(make_tree_image(run.scene, run.tracer.traversal().bvh(), configuration.chip, run.image.material_base));
    run.options.tree = &*tree;
  }
  const auto device = make_chip_model(run.options.configuration, make_model(configuration, run.image.memory, 1).device);
  const uint64_t cycles = run_board(run.options, *device).cycles;
  return {cycles, run.frame};
}

/// A value that the field has not in this configuration, as --set has it.
std::vector<std::string> other_values(const ConfigurationField& field, const Configuration& configuration) {
  const std::string present = value_text(nlohmann::ordered_json::parse(to_json(configuration)), field.path);
  std::vector<std::string> values;
  switch (field.range.form) {
    case Range::Form::Name:
      for (const std::string_view name : names_of(field.range)) values.emplace_back(name);
      break;
    case Range::Form::OnOff:
      values = {"true", "false"};
      break;
    default:
      for (const int value : {field.range.least, field.range.least + 1, 16, 1024, field.range.greatest})
        if (field.range.has(value)) values.push_back(std::to_string(value));
  }
  values.erase(std::remove(values.begin(), values.end(), present), values.end());
  return values;
}

TEST(UnusedFields, ChangeNoFrame) {
  struct Machine {
    std::vector<std::string> set;
    bool on_board;
  };
  const std::vector<Machine> machines = {
      {{"chip.traverser=static"}, false},
      {{"chip.traverser=static", "chip.policy=fill"}, true},
      {{"chip.traverser=modelled"}, false},
      {{"chip.traverser=modelled", "chip.policy=fill", "chip.modelled_traverser.nodes=exact"}, false},
      {{"chip.traverser=lanes"}, false},
      {{"chip.traverser=hardware", "chip.modelled_traverser.rays=16"}, true},
      {{"chip.traverser=static", "wide_ray_memory=true"}, false},
  };
  for (const Machine& machine : machines) {
    const Configuration configuration = load_configuration("4w4c", machine.set);
    const auto expected = drawn(configuration, machine.on_board);
    size_t tried = 0;
    for (const UnusedField& unused : unused_fields(configuration)) {
      const std::vector<ConfigurationField> all = fields();
      const auto field = std::find_if(all.begin(), all.end(), [&](const auto& f) { return f.path == unused.path; });
      for (const std::string& value : other_values(*field, configuration)) {
        std::vector<std::string> set = machine.set;
        set.push_back(unused.path + "=" + value);
        Configuration other;
        try {
          other = load_configuration("4w4c", set);
        } catch (const InputError&) {
          continue;  // not with the other fields
        }
        EXPECT_TRUE(drawn(other, machine.on_board) == expected) << set.front() << " " << set.back();
        ++tried;
        break;
      }
    }
    EXPECT_GT(tried, 0u);
  }
}

}  // namespace
}  // namespace raypool
