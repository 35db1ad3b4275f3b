// The blocks inside the controller, the queues of pools and memory port, and what joins the traverser to the chip.
#include <algorithm>
#include <array>
#include <deque>
#include <optional>

#include "lockstep/block_rules.hpp"
#include "machine/chip/kernel_policy.hpp"
#include "machine/chip/launch_records.hpp"
#include "machine/chip/launch_rules.hpp"
#include "machine/chip/tile_walk.hpp"
#include "machine/common/free_list.hpp"

namespace raypool::lockstep {
namespace {

class LaunchRecordsRule : public BlockRule {
 public:
  explicit LaunchRecordsRule(const Block& block) : BlockRule(block) {}
  void reset() override { records_ = {}; }
  void compare(Findings& findings) override {
    expect(findings, full_.value(), records_.full(), "all records are used");
    expect(findings, empty_.value(), records_.empty(), "no record is used");
    expect(findings, normal_.value(), records_.normal(), "rays that may still come");
    expect(findings, shadow_.value(), records_.shadow(), "shadow rays that may still come");
  }
  void take() override {
    if (ray_valid_.value() != 0) records_.ray_left(cycle_, ray_shadow_.value() != 0);
    if (contribution_valid_.value() != 0) records_.contribution_left(cycle_);
    if (ended_valid_.value() != 0) records_.kernel_ended(cycle_, static_cast<uint16_t>(ended_exports_.value()));
    // There is no launch while they are all used.
    if (launch_valid_.value() != 0 && !records_.full())
      records_.launch(cycle_, launch_normal_.value(), launch_shadow_.value());
    records_.settle(cycle_++);
  }

 private:
  Wire launch_valid_ = wire("launch_valid_i"), launch_normal_ = wire("launch_normal_i"),
       launch_shadow_ = wire("launch_shadow_i"), ray_valid_ = wire("ray_valid_i"), ray_shadow_ = wire("ray_shadow_i"),
       contribution_valid_ = wire("contribution_valid_i"), ended_valid_ = wire("ended_valid_i"),
       ended_exports_ = wire("ended_exports_i"), full_ = wire("full_o"), empty_ = wire("empty_o"),
       normal_ = wire("normal_o"), shadow_ = wire("shadow_o");
  LaunchRecords records_;
  uint64_t cycle_ = 0;
};

class TileWalkRule : public BlockRule {
 public:
  TileWalkRule(const Block& block, const Configuration& c)
      : BlockRule(block), start_walk_(c.chip.tile_order, c.contents(), c.chip.held_limit), walk_(start_walk_) {}
  void reset() override { walk_ = start_walk_; }
  void compare(Findings& findings) override {
    expect(findings, busy_.value(), walk_.busy(), "a tile is left");
    if (!expect(findings, valid_.value(), walk_.valid(), "a tile is offered") || !walk_.valid()) return;
    expect(findings, block_word_.value(), walk_.tile().block(), "corner of the tile");
    expect(findings, pixels_.value(), walk_.tile().pixels, "pixels of the tile");
  }
  void take() override {
    if (start_.value() != 0) {
      walk_.start(width_.value(), height_.value());
    } else {
      walk_.clock(ready_.value() != 0);
    }
  }

 private:
  Wire start_ = wire("start_i"), width_ = wire("width_i"), height_ = wire("height_i"), busy_ = wire("busy_o"),
       valid_ = wire("tile_valid_o"), ready_ = wire("tile_ready_i"), block_word_ = wire("tile_block_o"),
       pixels_ = wire("tile_pixels_o");
  TileWalk start_walk_, walk_;
};

class LaunchRulesRule : public BlockRule {
 public:
  LaunchRulesRule(const Block& block, const Configuration& c, uint32_t units)
      : BlockRule(block), begin_(c.chip, c.contents(), units), rules_(begin_) {}
  void reset() override { rules_ = begin_; }
  void compare(Findings& findings) override {
    const bool possible = left_.value() != 0 && rules_.may_cast(pixels_.value(), held_.value());
    expect(findings, eye_possible_.value(), possible, "a tile may be cast");
    expect(findings, room_.value(), rules_.secondary_room(shadow_rays_.value(), to_come_.value(), shadow_.value()),
           "most threads of a secondary kernel");
  }
  void take() override {
    if (cast_.value() != 0) rules_.cast(cast_held_.value());
  }

 private:
  Wire left_ = wire("tile_left_i"), pixels_ = wire("tile_pixels_i"), cast_ = wire("cast_i"),
       cast_held_ = wire("cast_held_i"), held_ = wire("held_i"), shadow_rays_ = wire("shadow_rays_i"),
       to_come_ = wire("shadow_to_come_i"), shadow_ = wire("shadow_i"), eye_possible_ = wire("eye_possible_o"),
       room_ = wire("secondary_room_o");
  LaunchRules begin_, rules_;
};

class PolicyRule : public BlockRule {
 public:
  PolicyRule(const Block& block, const Configuration& c, uint32_t units) : BlockRule(block) {
    const ChipConfiguration& chip = c.chip;
    for (uint32_t rays = 1; rays <= 2; ++rays)
      policies_[rays - 1] = make_policy(
          chip.policy, {c.contents(), units, chip.ray_pool_size, chip.intersection_pool_size, chip.thresholds_rays,
                        chip.thresholds_intersections, chip.static_traverser_batch, rays});
    if (chip.policy != PolicyName::Fill) return;
    to_come_ = wire("rays_to_come_i");
    promised_ = wire("promised_i");
    kernels_ = wire("kernels_i");
    two_rays_ = wire("two_rays_i");
  }
  void forget() override { choice_.reset(); }
  void compare(Findings& findings) override {
    if (!choice_) return;
    const auto kind = static_cast<uint32_t>(choice_->kind);
    const bool counted = choice_->kind == Choice::Kind::Secondary || choice_->kind == Choice::Kind::Shade;
    if (expect(findings, kind_.value(), kind, "kernel that is launched") && counted)
      expect(findings, threads_.value(), choice_->threads, "threads of the kernel");
  }
  void take() override {
    PolicyView view;
    view.rays = rays_.value();
    view.normal = normal_.value();
    view.shadow = shadow_.value();
    view.secondary_room = room_.value();
    view.rays_to_come = to_come_.value();
    view.promised = promised_.value();
    view.kernels = kernels_.value();
    view.eye_possible = eye_possible_.value() != 0;
    view.more_to_come = more_.value() != 0;
    view.ahead = ahead_.value() != 0;
    choice_ = policies_[two_rays_.value() != 0 ? 1 : 0]->choose(view);
  }

 private:
  Wire rays_ = wire("rays_i"), normal_ = wire("normal_i"), shadow_ = wire("shadow_i"), room_ = wire("secondary_room_i"),
       eye_possible_ = wire("eye_possible_i"), more_ = wire("more_to_come_i"), ahead_ = wire("ahead_i"),
       kind_ = wire("kind_o"), threads_ = wire("threads_o");
  Wire to_come_, promised_, kernels_, two_rays_;
  std::array<std::unique_ptr<KernelPolicy>, 2> policies_;  // a thread of a secondary kernel makes one ray, or two
  std::optional<Choice> choice_;                           // of what was seen in the cycle before
};

class QueueRule : public BlockRule {
 public:
  explicit QueueRule(const Block& block) : BlockRule(block) {}
  void reset() override { entries_.clear(); }
  void compare(Findings& findings) override {
    if (!expect(findings, valid_.value(), !entries_.empty(), "it holds something") || entries_.empty()) return;
    for (uint32_t low = 0; low < shown_.width(); low += 32)
      if (!expect(findings, shown_.part(low), entries_.front()[low / 32], "the oldest entry")) return;
  }
  void take() override {
    if (ready_.value() != 0 && !entries_.empty()) entries_.pop_front();
    if (push_.value() == 0) return;
    std::vector<uint32_t>& entry = entries_.emplace_back();
    for (uint32_t low = 0; low < data_.width(); low += 32) entry.push_back(data_.part(low));
  }

 private:
  Wire push_ = wire("push_i"), data_ = wire("data_i"), valid_ = wire("valid_o"), ready_ = wire("ready_i"),
       shown_ = wire("data_o");
  std::deque<std::vector<uint32_t>> entries_;
};

class FreeListRule : public BlockRule {
 public:
  FreeListRule(const Block& block, uint32_t size) : BlockRule(block), size_(size), list_(size) {}
  void reset() override { list_ = FreeList(size_); }
  void compare(Findings& findings) override {
    if (expect(findings, valid_.value(), list_.valid(), "a place is free") && list_.valid())
      expect(findings, number_.value(), list_.number(), "place that is free");
  }
  void take() override {
    if (ready_.value() != 0 && list_.valid()) list_.take();
    if (free_.value() != 0) list_.free(free_number_.value());
  }

 private:
  Wire valid_ = wire("valid_o"), ready_ = wire("ready_i"), number_ = wire("number_o"), free_ = wire("free_i"),
       free_number_ = wire("free_number_i");
  uint32_t size_;
  FreeList list_;
};

/// What the chip gives the traverser is what it has.
class JoinRule : public BlockRule {
 public:
  JoinRule(const Block& block, const ChipDevice& chip, const std::string& port, const std::string& signal)
      : BlockRule(block), what_("the traverser's " + port), port_(wire(port)), signal_(chip, "", signal) {}
  void compare(Findings& findings) override {
    for (uint32_t low = 0; signal_.present() && low < port_.width(); low += 32)
      if (!expect(findings, port_.part(low), signal_.part(low), what_.c_str())) return;
  }
  void take() override {}

 private:
  std::string what_;
  Wire port_, signal_;
};

/// Of its inputs that are signals of the chip: their names, and those of the signals.
constexpr std::array<std::array<const char*, 2>, 20> kJoins = {{{"root_i", "tree_root_i"},
                                                                {"lower_i", "tree_lower_i"},
                                                                {"upper_i", "tree_upper_i"},
                                                                {"triangles_line_i", "triangles_line_i"},
                                                                {"triangle_lines_i", "triangle_lines_i"},
                                                                {"stacks_line_i", "stacks_line_i"},
                                                                {"material_base_i", "material_base_i"},
                                                                {"record_i", "record_i"},
                                                                {"depth_limit_i", "depth_limit_i"},
                                                                {"reflections_i", "reflections_i"},
                                                                {"ray_valid_i", "ray_valid"},
                                                                {"ray_data_i", "ray_data"},
                                                                {"ray_last_i", "ray_last"},
                                                                {"ray_place_i", "ray_place"},
                                                                {"put_ready_i", "put_ready"},
                                                                {"contribution_ready_i", "contribution_ready"},
                                                                {"request_ready_i", "tree_request_ready"},
                                                                {"response_valid_i", "tree_response_valid"},
                                                                {"response_beat_i", "tree_response_beat"},
                                                                {"response_data_i", "tree_response_data"}}};

}  // namespace

void add_queue_rule(std::vector<std::unique_ptr<BlockRule>>& rules, const Block& queue) {
  add_rule<QueueRule>(rules, queue);
}

void add_controller_rules(std::vector<std::unique_ptr<BlockRule>>& rules, const Configuration& configuration,
                          const ChipDevice& rtl) {
  const Block controller{&rtl, "controller", "controller", "chip"};
  const uint32_t units = rtl.units();
  for (uint32_t unit = 0; unit < units; ++unit)
    add_rule<LaunchRecordsRule>(rules,
                                controller.inner(fmt::format("gen_unit[{}].launch_records", unit), "launch_records"));
  add_rule<TileWalkRule>(rules, controller.inner("tile_walk", "tile_walk"), configuration);
  add_rule<LaunchRulesRule>(rules, controller.inner("launch_rules", "launch_rules"), configuration, units);
  const bool fill = configuration.chip.policy == PolicyName::Fill;
  add_rule<PolicyRule>(rules,
                       fill ? controller.inner("gen_fill.policy", "fill_policy")
                            : controller.inner("gen_thesis.policy", "thesis_policy"),
                       configuration, units);
}

void add_pool_rules(std::vector<std::unique_ptr<BlockRule>>& rules, const Configuration& configuration,
                    const ChipDevice& rtl) {
  const Block port{&rtl, "memory_port", "memory_port", "chip"}, rays{&rtl, "ray_pool", "ray_pool", "chip"};
  for (const char* queue : {"device_requests", "traverser_requests", "lines"})
    add_queue_rule(rules, port.inner(queue, "ram_queue"));
  add_queue_rule(rules, rays.inner("order", "ram_queue"));
  const Block places = rays.inner("free_list", "free_list");
  add_queue_rule(rules, places.inner("returned", "ram_queue"));
  add_rule<FreeListRule>(rules, places, configuration.chip.ray_pool_size);
  if (!has_traverser(configuration.chip)) return;
  const Block traverser{&rtl, "gen_inside.traverser", "chip", "traverser"};
  for (const auto& [input, signal] : kJoins) add_rule<JoinRule>(rules, traverser, rtl, input, signal);
}

BlockRules::BlockRules(const Configuration& configuration, const ChipDevice& rtl) {
  add_controller_rules(chip, configuration, rtl);
  add_pool_rules(chip, configuration, rtl);
  if (has_traverser(configuration.chip)) add_traverser_rules(traverser, configuration, rtl);
}

}  // namespace raypool::lockstep
