// Fields that are reported as unused change no frame.
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

/// A frame of 8x8 pixels on this machine.
std::pair<uint64_t, FrameBuffer> drawn(const Configuration& configuration) {
  test::RealFrame run(configuration.warps, configuration.lanes, 8, 8, 2);
  run.options.configuration = configuration;
  std::optional<TreeImage> tree;
  if (has_traverser(configuration.chip)) {
    tree.emplace(make_tree_image(run.scene, run.tracer.traversal().bvh(), configuration.chip, run.image.material_base));
    run.options.tree = &*tree;
  }
  const uint64_t cycles = run.draw(make_model(configuration, run.image.memory, 1).device).cycles;
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
  const std::vector<std::vector<std::string>> machines = {
      {"chip.traverser=static"},
      {"chip.traverser=static", "chip.policy=fill"},
      {"chip.traverser=hardware", "chip.hardware_traverser.rays=16"},
      {"chip.traverser=hardware", "chip.policy=fill"},
      {"chip.traverser=static", "wide_ray_memory=true"},
  };
  for (const std::vector<std::string>& machine : machines) {
    const Configuration configuration = load_configuration("4w4c", machine);
    const auto expected = drawn(configuration);
    size_t tried = 0;
    for (const UnusedField& unused : unused_fields(configuration)) {
      const std::vector<ConfigurationField> all = fields();
      const auto field = std::find_if(all.begin(), all.end(), [&](const auto& f) { return f.path == unused.path; });
      for (const std::string& value : other_values(*field, configuration)) {
        std::vector<std::string> set = machine;
        set.push_back(unused.path + "=" + value);
        Configuration other;
        try {
          other = load_configuration("4w4c", set);
        } catch (const InputError&) {
          continue;  // not with the other fields
        }
        EXPECT_TRUE(drawn(other) == expected) << set.front() << " " << set.back();
        ++tried;
        break;
      }
    }
    EXPECT_GT(tried, 0u);
  }
}

}  // namespace
}  // namespace raypool
