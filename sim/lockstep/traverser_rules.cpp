// Banks of the traverser's caches, its triangle pipes, and the arithmetic that its set-up and its pipes share.
#include <cmath>

#include "bits.hpp"
#include "lockstep/block_rules.hpp"
#include "machine/traverser/tree_cache.hpp"
#include "machine/traverser/triangle_pipe.hpp"

namespace raypool::lockstep {
namespace {

class TreeCacheRule : public BlockRule {
 public:
  TreeCacheRule(const Block& block, const TreeCache::Sizes& sizes) : BlockRule(block), sizes_(sizes), cache_(sizes) {
    slot_bits_ = slots_.width() / sizes.lanes;
  }
  void reset() override { cache_ = TreeCache(sizes_); }
  void compare(Findings& findings) override {
    expect(findings, ready_.value(), cache_.ready() && fill_valid_.value() == 0, "a lookup is taken");
    const TreeCache::Given& given = cache_.given();
    if (expect(findings, given_lanes_.value(), given.lanes, "lanes that are given a line"))
      for (uint32_t lanes = given.lanes; lanes != 0; lanes &= lanes - 1)
        expect(findings, slot(given_slots_, lowest(lanes)), given.slots[lowest(lanes)], "slot that is given a line");
    if (expect(findings, offer_valid_.value(), cache_.offers(), "a line that has come is offered") && cache_.offers())
      expect(findings, offer_lane_.value(), 1u << cache_.offer_lane(), "lane that has waited");
    if (expect(findings, request_valid_.value(), cache_.request_valid(), "a line is asked for") &&
        cache_.request_valid()) {
      expect(findings, request_line_.value(), cache_.request_line(), "line that is asked for");
      expect(findings, request_id_.value(), cache_.request_id(), "register of the request");
    }
    if (fill_valid_.value() != 0) expect(findings, fill_ready_.value(), cache_.fill_ready(), "a line is taken");
  }
  void take() override {
    TreeCache::Inputs inputs;
    inputs.fill = fill_valid_.value() != 0;
    inputs.fill_id = fill_id_.value();
    if (valid_.value() != 0 && cache_.ready() && !inputs.fill) {
      lookup_ = {line_.value(), lanes_.value(), {}};
      for (uint32_t lanes = lookup_.lanes; lanes != 0; lanes &= lanes - 1)
        lookup_.slots[lowest(lanes)] = static_cast<uint8_t>(slot(slots_, lowest(lanes)));
      inputs.lookup = &lookup_;
    }
    inputs.offer_taken = offer_ready_.value() != 0 && cache_.offers();
    inputs.request_taken = request_ready_.value() != 0 && cache_.request_valid();
    cache_.clock(inputs);
  }

 private:
  uint32_t slot(const Wire& slots, uint32_t lane) const { return slots.bits(lane * slot_bits_, slot_bits_); }

  Wire valid_ = wire("valid_i"), ready_ = wire("ready_o"), line_ = wire("line_i"), lanes_ = wire("lanes_i"),
       slots_ = wire("slots_i"), given_lanes_ = wire("given_lanes_o"), given_slots_ = wire("given_slots_o"),
       offer_valid_ = wire("offer_valid_o"), offer_ready_ = wire("offer_ready_i"), offer_lane_ = wire("offer_lane_o"),
       request_valid_ = wire("request_valid_o"), request_ready_ = wire("request_ready_i"),
       request_line_ = wire("request_line_o"), request_id_ = wire("request_id_o"), fill_valid_ = wire("fill_valid_i"),
       fill_ready_ = wire("fill_ready_o"), fill_id_ = wire("fill_id_i");
  TreeCache::Sizes sizes_;
  TreeCache cache_;
  TreeCache::Lookup lookup_;
  uint32_t slot_bits_ = 1;
};

/// Of significands that begin with a one.
class QuotientDigitsRule : public BlockRule {
 public:
  explicit QuotientDigitsRule(const Block& block) : BlockRule(block) {}
  void forget() override { begun_.clear(); }
  void compare(Findings& findings) override {
    const Digits* const digits = begun_.ago(1 + digits_.width() / 2);
    if (digits == nullptr) return;
    expect(findings, digits_.wide(0, digits_.width()), digits->bits, "digits of a quotient");
    expect(findings, rest_.value(), digits->rest, "something is left of a quotient");
  }
  void take() override {
    const uint32_t bits = a_.width();
    const uint64_t a = a_.wide(0, bits), b = b_.wide(0, bits), left = a < b ? 2 * a - b : a - b;
    begun_.push({(left << bits) / b, (left << bits) % b != 0});
  }

 private:
  struct Digits {
    uint64_t bits;
    bool rest;
  };
  Wire a_ = wire("a_i"), b_ = wire("b_i"), digits_ = wire("digits_o"), rest_ = wire("rest_o");
  History<Digits> begun_;
};

class FloatQuotientRule : public BlockRule {
 public:
  explicit FloatQuotientRule(const Block& block) : BlockRule(block) {}
  void forget() override { begun_.clear(); }
  void compare(Findings& findings) override {
    const uint32_t fraction = shown_.width() - 1 - kExponentBits;
    const uint64_t* const quotient = begun_.ago(2 + (fraction + 1) / 2);
    if (quotient != nullptr) expect(findings, shown_.wide(0, shown_.width()), *quotient, "quotient");
  }
  void take() override {
    constexpr uint32_t kSpecial = (1u << kExponentBits) - 1;
    const uint32_t bits = shown_.width() - 1 - kExponentBits;
    const Number a = Number::of(a_.wide(0, a_.width()), bits), b = Number::of(b_.wide(0, b_.width()), bits);
    const uint64_t one = uint64_t{1} << bits, x = one | a.fraction, y = one | b.fraction,
                   left = x < y ? 2 * x - y : x - y;
    // One bit more than stays decides.
    const uint64_t digits = (left << (bits + 1)) / y;
    const uint32_t exponent = (a.exponent - b.exponent + kExponentBias - (x < y ? 1 : 0)) & kSpecial;
    const uint64_t sign = uint64_t{a.negative != b.negative} << (bits + kExponentBits);
    if (b.exponent == 0) {
      begun_.push(sign | uint64_t{kSpecial} << bits | (a.exponent == 0 ? one >> 1 : 0));
    } else {
      begun_.push(a.exponent == 0 ? sign
                                  : sign | uint64_t{exponent} << bits | (((digits >> 1) + (digits & 1)) & (one - 1)));
    }
  }

 private:
  Wire a_ = wire("a_i"), b_ = wire("b_i"), shown_ = wire("quotient_o");
  History<uint64_t> begun_;
};

class FloatShortenRule : public BlockRule {
 public:
  explicit FloatShortenRule(const Block& block) : BlockRule(block) {}
  void forget() override { begun_.clear(); }
  void compare(Findings& findings) override {
    const uint32_t* const expected = begun_.ago(2);
    if (expected != nullptr) expect(findings, shown_.value(), *expected, "number as a float");
  }
  void take() override {
    constexpr uint32_t kSpecial = (1u << kExponentBits) - 1, kInfinite = 0x7f800000, kNaN = 0x7fc00000;
    const uint32_t bits = number_.width() - 1 - kExponentBits;
    const Number number = Number::of(number_.wide(0, number_.width()), bits);
    uint32_t size = 0;
    if (number.exponent == kSpecial) {
      size = number.fraction != 0 ? kNaN : kInfinite;
    } else if (number.exponent != 0) {
      // A double has as many bits, or more, and rounds to the nearest even one as it becomes a float.
      const double value = std::ldexp(static_cast<double>(uint64_t{1} << bits | number.fraction),
                                      static_cast<int>(number.exponent) - kExponentBias - static_cast<int>(bits));
      size = as_bits(static_cast<float>(value));
    }
    begun_.push(size | (number.negative ? 1u << 31 : 0));
  }

 private:
  Wire number_ = wire("number_i"), shown_ = wire("float_o");
  History<uint32_t> begun_;
};

/// The parts of a triangle pipe, each of the ray and the triangle that the pipe is given.
class TrianglePartsRule : public BlockRule {
 public:
  explicit TrianglePartsRule(const Block& block) : BlockRule(block) {}
  void reset() override { begun_.clear(); }
  void forget() override { begun_.clear(); }
  void compare(Findings& findings) override {
    constexpr size_t kView = 11, kInterval = 15, kEdges = 16;
    if (const Test* const test = at(kView)) {
      const std::string files = "rtl/traverser/rp_triangle_view.v, rtl/traverser/rp_triangle_pipe.v";
      for (uint32_t corner = 0; corner < 3; ++corner) {
        expect(findings, x_.word(corner), test->x[corner], "corner's place across the ray", files);
        expect(findings, y_.word(corner), test->y[corner], "corner's place across the ray", files);
      }
      expect(findings, in_front_.value(), test->in_front, "corners in front of the ray", files);
    }
    if (const Test* const test = at(kInterval)) {
      const std::string files = "rtl/traverser/rp_triangle_interval.v, rtl/traverser/rp_triangle_pipe.v";
      expect(findings, near_.value(), test->near, "when the ray enters the triangle's box", files);
      expect(findings, far_.value(), test->far, "when the ray leaves the triangle's box", files);
      expect(findings, met_.value(), test->near <= test->far, "the triangle's box is met", files);
    }
    if (const Test* const test = at(kEdges))
      expect(findings, inside_.value(), test->inside, "the ray passes inside the edges",
             "rtl/traverser/rp_triangle_edges.v, rtl/traverser/rp_triangle_pipe.v");
    const Test* const test = at(kPlane);
    if (test == nullptr || (std::isnan(as_float(t_.value())) && std::isnan(test->t))) return;
    expect(findings, t_.value(), as_bits(test->t), "time of the triangle's plane",
           "rtl/traverser/rp_triangle_plane.v, rtl/arith/rp_float_widen.v");
  }
  void take() override { begun_.push(valid_.value() != 0 ? test() : Test{}); }

 private:
  static constexpr uint32_t kBits = 32;
  static constexpr size_t kPlane = 24 + kBits / 2;

  struct Test {
    bool valid = false, inside = false;
    uint32_t x[3] = {}, y[3] = {}, in_front = 0, near = 0, far = 0;
    float t = 0;
  };
  const Test* at(size_t ago) const {
    const Test* const test = begun_.ago(ago);
    return test != nullptr && test->valid ? test : nullptr;
  }
  TriangleRay ray() const {
    constexpr uint32_t kFraction = 23, kWidth = 1 + kExponentBits + kFraction;
    TriangleRay ray;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      ray.origin[axis] = as_float(origin_.word(axis));
      ray.padded[0][axis] = as_float(lower_.word(axis));
      ray.padded[1][axis] = as_float(upper_.word(axis));
      ray.inverse[axis] = as_float(inverse_.word(axis));
      ray.near_side[axis] = std::signbit(ray.inverse[axis]) ? 1 : 0;
      const Number number = Number::of(direction_.wide(kWidth * axis, kWidth), kFraction);
      const double size = number.exponent == 0
                              ? 0
                              : std::ldexp(static_cast<double>(1u << kFraction | number.fraction),
                                           static_cast<int>(number.exponent) - kExponentBias - int{kFraction});
      ray.direction[axis] = number.negative ? -size : size;
    }
    ray.kz = static_cast<int>(main_axis_.value()) % 3;
    ray.kx = (ray.kz + 1) % 3;
    ray.ky = (ray.kz + 2) % 3;
    ray.shear_x = as_float(shear_.word(0));
    ray.shear_y = as_float(shear_.word(1));
    return ray;
  }
  Test test() const {
    const TriangleRay ray = this->ray();
    Triangle triangle;
    triangle.number = 0;
    for (uint32_t word = 0; word < 9; ++word) triangle.corners[word / 3][word % 3] = as_float(corners_.word(word));
    const CornersInView view(ray, triangle);
    Test test;
    test.valid = true;
    for (uint32_t corner = 0; corner < 3; ++corner) {
      test.x[corner] = as_bits(view.x[corner]);
      test.y[corner] = as_bits(view.y[corner]);
      const bool front = static_cast<double>(view.z[corner]) * ray.direction[ray.kz] > 0;
      test.in_front |= (front ? 1u : 0u) << corner;
    }
    test.inside = TriangleEdges(view.x, view.y).inside();
    float near = 0, far = 0;
    triangle::own_box_interval(ray, triangle, near, far);
    // As hardware has them: not negative.
    test.near = near > 0 ? as_bits(near) : 0;
    test.far = far > 0 ? as_bits(far) : 0;
    test.t = static_cast<float>(plane_time(NarrowFloat(kBits), ray, triangle));
    return test;
  }

  Block interval_ = block().inner("interval", "triangle_interval");
  Wire valid_ = wire("valid_i"), corners_ = wire("corners_i"), origin_ = wire("origin_i"),
       lower_ = wire("padded_lower_i"), upper_ = wire("padded_upper_i"), inverse_ = wire("inverse_i"),
       main_axis_ = wire("main_axis_i"), shear_ = wire("shear_i"), direction_ = wire("direction_i"), x_ = wire("x"),
       y_ = wire("y"), in_front_ = wire("in_front"), inside_ = wire("inside"), near_ = wire_of(interval_, "near_o"),
       far_ = wire_of(interval_, "far_o"), met_ = wire_of(interval_, "met_o"), t_ = wire("t");
  History<Test> begun_;
};

/// A test is given the answer of its own lane, which it asked in the cycle before.
class TriangleGroupRule : public BlockRule {
 public:
  explicit TriangleGroupRule(const Block& block) : BlockRule(block) {}
  void forget() override { limit_of_ = best_of_ = kNoLane; }
  void compare(Findings& findings) override {
    if (limit_of_ != kNoLane) {
      expect(findings, told_limit_.value(), limit_.word(limit_of_), "limit that a test is given");
      expect(findings, told_scale_.value(), scale_.bits(9 * limit_of_, 9), "scale that a test is given");
    }
    if (best_of_ == kNoLane) return;
    expect(findings, told_best_t_.value(), best_t_.word(best_of_), "time of the best hit that a test is given");
    expect(findings, told_best_number_.value(), best_number_.word(best_of_), "best triangle that a test is given");
  }
  void take() override {
    limit_of_ = asks_limit_.value() != 0 ? limit_lane_.value() : kNoLane;
    best_of_ = asks_best_.value() != 0 ? best_lane_.value() : kNoLane;
  }

 private:
  static constexpr uint32_t kNoLane = UINT32_MAX;

  Block pipe_ = block().inner("triangles", "triangle_pipe");
  Wire asks_limit_ = wire("asks_limit"), asks_best_ = wire("asks_best"), limit_lane_ = wire("limit_lane"),
       best_lane_ = wire("best_lane"), limit_ = wire("limit_i"), scale_ = wire("scale_i"), best_t_ = wire("best_t_i"),
       best_number_ = wire("best_number_i");
  Wire told_limit_ = wire_of(pipe_, "limit_i"), told_scale_ = wire_of(pipe_, "scale_i"),
       told_best_t_ = wire_of(pipe_, "best_t_i"), told_best_number_ = wire_of(pipe_, "best_number_i");
  uint32_t limit_of_ = kNoLane, best_of_ = kNoLane;
};

void add_cache_rules(std::vector<std::unique_ptr<BlockRule>>& rules, const Block& banks, const TreeCache::Sizes& sizes,
                     uint32_t count) {
  for (uint32_t bank = 0; bank < count; ++bank) {
    const Block cache = banks.inner(fmt::format("gen_bank[{}].bank", bank), "tree_cache");
    add_queue_rule(rules, cache.inner("requests", "ram_queue"));
    add_rule<TreeCacheRule>(rules, cache, sizes);
  }
}

}  // namespace

void add_quotient_rule(std::vector<std::unique_ptr<BlockRule>>& rules, const Block& digits) {
  add_rule<QuotientDigitsRule>(rules, digits);
}

void add_shorten_rule(std::vector<std::unique_ptr<BlockRule>>& rules, const Block& shorten) {
  add_rule<FloatShortenRule>(rules, shorten);
}

void add_triangle_rules(std::vector<std::unique_ptr<BlockRule>>& rules, const Block& group) {
  const Block pipe = group.inner("triangles", "triangle_pipe"), plane = pipe.inner("plane", "triangle_plane");
  const Block quotient = plane.inner("quotient", "float_quotient");
  add_quotient_rule(rules, quotient.inner("digit_array", "quotient_digits"));
  add_rule<FloatQuotientRule>(rules, quotient);
  add_shorten_rule(rules, plane.inner("shorten", "float_shorten"));
  add_rule<TrianglePartsRule>(rules, pipe);
  add_rule<TriangleGroupRule>(rules, group);
}

void add_traverser_rules(std::vector<std::unique_ptr<BlockRule>>& rules, const Configuration& configuration,
                         const ChipDevice& rtl) {
  const ChipConfiguration& chip = configuration.chip;
  const Block traverser{&rtl, "gen_inside.traverser", "traverser", "chip"};
  const uint32_t banks = chip.hardware_traverser_cache_banks, lanes = chip.hardware_traverser_lanes;
  constexpr uint32_t kLine = 64;
  const Block direction{&rtl, traverser.scope + ".setup.direction", "ray_direction", "ray_setup"};
  for (const char* digits : {"inverse_digits", "aside_digits"})
    add_quotient_rule(rules, direction.inner(digits, "quotient_digits"));
  add_cache_rules(rules, traverser.inner("nodes", "tree_banks"),
                  {lanes, chip.hardware_traverser_node_cache_bytes / kLine / banks,
                   chip.hardware_traverser_node_cache_ways, chip.hardware_traverser_node_cache_mshrs / banks},
                  banks);
  add_cache_rules(rules, traverser.inner("triangles", "tree_banks"),
                  {lanes + 1, chip.hardware_traverser_triangle_cache_bytes / kLine / banks,
                   chip.hardware_traverser_triangle_cache_ways, chip.hardware_traverser_triangle_cache_mshrs / banks},
                  banks);
  for (uint32_t lane = 0; lane < lanes; ++lane) {
    const Block one = traverser.inner(fmt::format("gen_lane[{}].lane", lane), "traverser_lane");
    for (const char* queue : {"begins", "ends"}) add_queue_rule(rules, one.inner(queue, "ram_queue"));
  }
  for (uint32_t pipe = 0; pipe < chip.hardware_traverser_triangle_pipes; ++pipe)
    add_triangle_rules(rules, traverser.inner(fmt::format("gen_group[{}].pipe", pipe), "triangle_group"));
  const Block exit = traverser.inner("exit", "ray_exit");
  add_finish_rules(rules, exit.inner("finish", "ray_finish"));
}

}  // namespace raypool::lockstep
