// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// A shader becomes intermediate code of the kernel compiler. Blocks of SPIR-V become code under masks: each construct
// is recorded once, in order, and a lane that leaves it early is masked out until the place that it has gone to.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "kernel/kernel.hpp"
#include "machine/chip/ray_kernel.hpp"
#include "shader/module.hpp"
#include "shader/values.hpp"
#include "shader/waits.hpp"

namespace raypool::shader {

/// Shaders that executeCallableEXT counts.
using Callables = std::vector<const Module*>;

/// Which of the ray kernels a shader becomes. Throws InputError with file and line for what cannot be done.
/// `layout`: of the intersections that it imports.
kernel::Function lower(const Module& module, const Resources& resources, RayKernel kernel, const KernelTarget& target,
                       const RecordLayout& layout = {}, const Callables* callables = nullptr);

/// Shaders that wait for their rays: module and sites of each.
struct WaitingShader {
  const Module& module;
  const Waits& waits;
};
/// With the hit groups that it is part of.
struct ClosestHitShader {
  WaitingShader shader;
  std::vector<uint32_t> groups;
};
/// Decides of hits of rays to these hit groups whether they count.
struct AnyHitShader {
  const Module& module;
  std::vector<uint32_t> groups;
};
struct WaitingShaders {
  WaitingShader ray_generation;
  std::vector<WaitingShader> misses;  ///< by the index of a traceRayEXT
  std::vector<ClosestHitShader> closest_hits;
  std::vector<AnyHitShader> any_hits;
  Callables callables;
  uint32_t groups = 1;
};

/// CastEye or CastSecondary of shaders that wait: the first begins paths, the second goes on with them.
kernel::Function lower_waiting(const WaitingShaders& shaders, const Resources& resources, RayKernel kernel,
                               const KernelTarget& target, const RecordLayout& layout = {});

/// Words of a path's record: those of a payload that a ray has no room for, then what each stage holds across traces.
/// `levels`: Resources::levels.
uint32_t path_words(const WaitingShaders& shaders, uint32_t levels);

/// A contribution that waits to leave.
struct Stored {
  int lanes = 0;                 ///< a predicate
  std::array<Scalar, 4> values;  ///< registers: pixel and colour
};

/// Of the paths that a kernel goes on with.
struct Path {
  const WaitingShaders& shaders;
  bool comes_back = false;  ///< lanes come with a ray that has been traced
  Scalar site;              ///< a register: the trace behind which a lane goes on; 0: none
  int sends = 0;            ///< predicate: a ray leaves at the end
  /// Contributions that leave at the end: a lane runs one shader of each stage.
  std::map<spv::ExecutionModel, std::vector<Stored>> stored;
  Scalar record;  ///< a register: where the path's record lies behind Resources::saved, bytes
  /// Where closest-hit shaders wait for each other: registers with how many of the path wait and with the trace that
  /// has called, and of the lanes that have just come a predicate.
  std::optional<Scalar> level, caller;
  std::optional<int> fresh;
  /// Loads see what the path may have stored in another unit.
  bool shares_buffers = false;
  /// Predicate: the hit does not count, and the ray goes on behind it. None: all hits count.
  std::optional<int> ignored;
};

/// A kernel that is being recorded, of one shader or several.
struct Recording {
  Recording(RayKernel kernel, const KernelTarget& target, const RecordLayout& layout, const Callables* all_callables)
      : recorder(std::string(kRayKernelNames[kernel]), target.fma),
        k(recorder, target.culling, layout),
        callables(all_callables) {}

  kernel::Recorder recorder;
  kernel::RecordedKernel k;
  std::optional<Scalar> pixel, flags;  ///< words of the ray that has come
  std::optional<int> saved;            ///< register: where the thread's own memory lies, bytes
  std::optional<Path> path;            ///< of a kernel of shaders that wait
  const Callables* callables;          ///< null: none
  std::vector<const Module*> called;   ///< those that are being recorded, the first of which called the others
};

class Lowering {
 public:
  /// `kernel`: which the shader becomes, or would if it did not wait.
  Lowering(const Module& module, const Resources& resources, RayKernel kernel, Recording& recording);
  kernel::Function run();

  // lowering_paths.cpp: kernels of shaders that wait. What all of them share comes first; it gives the lanes that
  // begin.
  Scalar begin_paths();
  /// Rays whose hits do not count: by their flags, and by what an any-hit shader decides. They go on.
  void ignore_sides();
  void run_any_hit(const AnyHitShader& shader);
  void pass_on();
  void give_back_unread();
  void begin_calls();
  void end_calls();
  Scalar goes_to_miss(uint32_t index);
  Scalar called_by_hit(const std::vector<uint32_t>& groups);
  /// Lanes of `starts` begin the shader, others go on behind its sites. `first_word`: of the path's record, for what
  /// they hold.
  void run_waiting(const Waits& waits, const Scalar& starts, uint32_t first_word);
  void forget_record();
  void forget(const Scalar& base, uint32_t first, uint32_t last);
  kernel::Function end_paths();

 private:
  void constants();
  kernel::Function finished();
  Scalar place_pixel();
  void place_saved();
  using RecordedInt = kernel::RecordedKernel::Int;
  using RecordedFloat = kernel::RecordedKernel::Float;
  using RecordedBool = kernel::RecordedKernel::Bool;

  // lowering_control.cpp: blocks
  struct Flow {
    std::set<uint32_t> leaves;  // labels of outer constructs to which lanes go
    bool falls = false;         // lanes arrive at the end
  };
  static constexpr uint32_t kEnd = 0;               // of main()
  static constexpr uint32_t kIgnored = UINT32_MAX;  // of an any-hit shader whose hit does not count
  Flow flow(uint32_t label, uint32_t stop);
  Flow flow_of_loop(const Block& header);
  Flow flow_of_switch(const Block& header);
  /// A label of a switch and its values; the default's are left out.
  struct Case {
    uint32_t label = 0;
    std::vector<uint32_t> literals;
    bool is_default = false;
  };
  static std::set<uint32_t> falls_into(const Module& module, const Block& header, const Case& from,
                                       const std::vector<Case>& cases);
  static std::vector<Case> cases_of(const Module& module, const Block& header);
  Scalar matches(const std::vector<Case>& cases, const Case& one, const Scalar& selector);
  void region(uint32_t label, uint32_t stop);
  void lines(const Block& block);
  /// Those from `first` on, less than `end`.
  void lines(const Block& block, size_t first, size_t end);
  void selection(const Block& block, uint32_t stop);
  /// One of which the side that is taken is known. Returns false, with nothing done, where it is like any other.
  bool known_selection(const Block& block, uint32_t taken, uint32_t stop);
  /// Lanes that jump over an arm, from the op `begin` on, do not hold before it what the merge takes from the arms.
  void declare_arms(size_t begin, int first_register, const Block& merge, const std::array<uint32_t, 2>& from);
  void unmerged_branch(const Block& block, uint32_t stop);
  void loop(const Block& header, uint32_t stop);
  std::set<uint32_t> blocks_within(const Block& header, uint32_t stop) const;
  void keep_beyond(const Block& header, uint32_t stop);
  void switch_over(const Block& header, uint32_t stop);
  /// Lanes of the mask go from one block to another: phis and masks.
  void edge(uint32_t from, uint32_t to);
  void go(uint32_t from, uint32_t to, uint32_t stop);
  bool is_open(uint32_t label) const;
  bool has_phis(uint32_t label) const { return label != kEnd && !module_.block(label).phis.empty(); }
  void declare_phis(uint32_t label);
  void select_phis(const Block& merge, const Scalar& condition, uint32_t from_then, uint32_t from_else);
  Value incoming(const Line& phi, uint32_t from);
  void continue_at(uint32_t merge, uint32_t stop, bool masked);
  size_t predecessors(uint32_t label) const;
  void under(const Scalar& chosen, const std::function<void()>& body);

  // lowering_waits.cpp: code that lanes enter behind a trace. alive_ is those of the mask that are here; others of it
  // wait for a trace that comes later. A region ends with lanes in the predicates of the places where they go.
  void waiting_region(uint32_t label, uint32_t stop);
  void waiting_inner(uint32_t label, uint32_t stop);
  void waiting_construct(const Block& block, uint32_t stop);
  void waiting_lines(const Block& block);
  void waiting_sides(const Block& block, uint32_t stop);
  void waiting_side(const Scalar& chosen, uint32_t from, uint32_t to, uint32_t stop);
  void waiting_go(uint32_t from, uint32_t to, uint32_t stop);
  void waiting_loop(const Block& header);
  void waiting_switch(const Block& header);
  std::set<uint32_t> sites_from(uint32_t label, uint32_t stop) const;
  /// Lanes that go on behind one of these sites.
  Scalar coming(const std::set<uint32_t>& sites);
  void wait(const Line& line);

  // lowering_paths.cpp: what rays and records take along
  bool goes_to_no_closest_hit(const Line& line);
  bool waits_on_a_level() const;
  Scalar place_held();
  void send(const Line& line, const TraceSite& site);
  void go_on(const TraceSite& site);
  void take_payload_back(const Line& line);
  void flush_products();
  void declare_held();
  template <typename Visit>
  void for_each_held(const TraceSite& site, const Visit& visit);
  Scalar from_word(const Scalar& word, bool is_condition);
  Scalar word_at(const Scalar& place, uint32_t number);
  void put_word_at(const Scalar& place, uint32_t number, const Scalar& value);
  Scalar record_word(uint32_t number);
  void put_record_word(uint32_t number, const Scalar& value);
  /// Payload of a ray that has come, and what goes back to the shader that has traced it.
  void take_payload(uint32_t id, uint32_t type);
  void give_payload();
  /// Of the trace that has called: what `of` gives for it.
  template <typename Of>
  Scalar of_site(const Of& of);
  Scalar flags_of_trace();
  Scalar least_distance();
  Scalar began();
  Value ray_origin();
  Value ray_words(int first);
  Scalar payload_scalar(uint32_t number);
  void put_passed(uint32_t number, const Scalar& scalar);
  void put_back(uint32_t number, const Scalar& scalar);
  template <typename Put>
  void for_each_payload(const Put& put);
  Scalar plus(const Scalar& a, const Scalar& b);
  Scalar has_flag(uint32_t flag);
  Scalar goes_to_groups(const std::vector<uint32_t>& groups);
  void declare_stored(const Module& shader);
  void store_later(const Value& place, const Value& colour);

  // lowering_values.cpp: scalars
  Value get(uint32_t id);
  Scalar get_scalar(uint32_t id) { return get(id).at(0); }
  void set(const Line& line, Value value);
  Scalar kept(uint32_t id, size_t number, const Scalar& scalar);
  int reg(const Scalar& scalar);
  int predicate(const Scalar& scalar);
  kernel::Condition condition(const Scalar& scalar);
  RecordedInt as_int(const Scalar& scalar);
  RecordedFloat as_float(const Scalar& scalar);
  RecordedBool as_bool(const Scalar& scalar);
  Scalar of(const RecordedInt& value) { return Scalar::in_register(value.number()); }
  Scalar of(const RecordedFloat& value) { return Scalar::in_register(value.number()); }
  Scalar of(const RecordedBool& value) { return Scalar::in_predicate(value.number()); }
  Scalar binary(Opcode opcode, const Scalar& a, const Scalar& b);
  Scalar compare(Opcode opcode, const Scalar& a, const Scalar& b);
  Scalar unary(Opcode opcode, const Scalar& a);
  Scalar immediate(Opcode opcode, const Scalar& a, uint32_t bits);
  Scalar multiply_add(const Scalar& a, const Scalar& b, const Scalar& c);
  Scalar negate(const Scalar& a) { return immediate(Opcode::Xor, a, 0x80000000u); }
  Scalar select(const Scalar& condition, const Scalar& a, const Scalar& b);
  /// The same of values of a type: of two constants that are conditions a condition comes.
  Value select(uint32_t type, const Value& conditions, const Value& a, const Value& b);
  Scalar both(const Scalar& a, const Scalar& b);
  Scalar either(const Scalar& a, const Scalar& b);
  static Scalar inverse(Scalar a);
  Scalar copy(const Scalar& a);
  void assign(Scalar& variable, const Scalar& source);
  Scalar declare(bool is_condition);
  bool is_condition(uint32_t type, uint32_t scalar) const;
  Scalar narrowed(uint32_t type, const Scalar& value);
  Scalar narrowed_result(const Line& line, const Scalar& value);
  Scalar upper_product(const Scalar& a, const Scalar& b, bool is_signed);
  static uint32_t log2_of(uint32_t power);
  uint32_t type_of(uint32_t id) const { return module_.type_of(id); }

  // lowering_operations.cpp: what lines compute
  void operation(const Line& line);
  bool arithmetic(const Line& line);
  bool conversion(const Line& line);
  /// The instruction's value, scalar by scalar of its one or two operands.
  template <typename OfScalars>
  bool set_each(const Line& line, const OfScalars& of_scalars) {
    const Value a = get(line.operands.at(0));
    const Value b = line.operands.size() > 1 ? get(line.operands[1]) : a;
    Value value(a.size());
    for (size_t i = 0; i < a.size(); ++i) value[i] = of_scalars(a[i], b[i]);
    set(line, value);
    return true;
  }
  bool comparison(const Line& line);
  bool logic(const Line& line);
  bool composite(const Line& line);
  bool matrix(const Line& line);
  void glsl(const Line& line);
  std::optional<Value> glsl_of_floats(const Line& line, const std::vector<Value>& a);
  std::optional<Value> glsl_of_integers(const Line& line, const std::vector<Value>& a);
  std::optional<Value> glsl_of_vectors(const Line& line, const std::vector<Value>& a);
  Value with_second(const Line& line, Value first, const Value& second, bool by_pointer);
  Scalar determinant(const Value& matrix);
  static Value without(const Value& matrix, size_t size, size_t row, size_t column);
  Value inverse_matrix(const Value& matrix);
  Scalar dot(const Value& a, const Value& b);
  Value dynamic_part(const Value& whole, uint32_t part_scalars, const Scalar& index);
  void product(const Line& line);
  bool is_fused_later(const Line& line) const;

  // lowering_wide.cpp
  bool wide_integers(const Line& line);
  std::optional<Value> of_wide(const Line& line, bool gives, const Value& a, const Value& b);
  Value wide_sum(bool adds, const Value& a, const Value& b);
  Value wide_product(const Value& a, const Value& b);
  Value wide_shift(bool is_left, const Value& a, uint32_t places);

  // lowering_memory.cpp: pointers
  void begin_variables();
  void keep(uint32_t id, uint32_t type, const Value& first);
  void access(const Line& line);
  void set_address(const Line& line, const Scalar& address);
  void load(const Line& line);
  void store(const Line& line);
  Value load_from(const Pointer& pointer);
  void store_to(const Pointer& pointer, const Value& value);
  Value chosen_part(const Value& whole, const Pointer& pointer, size_t depth, uint32_t offset, uint32_t size);
  void store_chosen(Value& whole, const Pointer& pointer, size_t depth, uint32_t offset, const Value& value);
  Pointer pointer_of(uint32_t id);
  Pointer global(uint32_t id, const Variable& variable);
  const std::vector<Word>* known_words(const Variable& variable, const Place& place) const;
  void step_into(Pointer& pointer, uint32_t index_id);
  /// Calls leaf(offset in bytes) for each scalar of a type in memory.
  template <typename Leaf>
  void for_each_scalar(uint32_t type, uint32_t offset, uint32_t component_stride, uint32_t column_stride,
                       const Leaf& leaf);
  /// A register's value and what is added to it, in bytes.
  std::pair<Scalar, uint32_t> address(const Pointer& pointer);
  Scalar word_scalar(const Word& word);
  Value read_words(const Pointer& pointer);
  Scalar scaled(const Scalar& index, uint32_t stride);
  const Value& variable(uint32_t id);
  void sample(const Line& line);
  void fetch(const Line& line);
  void query_size(const Line& line);

  // lowering_callables.cpp
  void execute_callable(const Line& line);
  /// Of a callable shader: its data, before and behind it.
  Value run_callable(const Value& data);

  // lowering_rays.cpp: what comes and leaves
  Scalar geometry();
  Value built_in(uint32_t number, uint32_t type);
  Value hit_attribute(uint32_t type);
  void load_payload(uint32_t id, const Variable& variable);
  void trace(const Line& line);
  uint32_t ray_flags(const Line& line);
  Scalar put_ray(const Line& line);
  void write_picture(const Line& line);
  void put_word(int number, const Scalar& value);
  void put_payload(uint32_t id, bool shadow);
  std::vector<std::pair<int, bool>> payload_words(uint32_t type) const;

  [[noreturn]] void fail(const std::string& what) const { module_.fail(where_, what); }

  const Module& module_;
  const Resources& resources_;
  RayKernel kernel_;
  kernel::Recorder& recorder_;
  kernel::RecordedKernel& k_;
  std::optional<Scalar>&pixel_, &flags_;  // words of the ray that has come
  std::optional<int>& saved_;
  std::optional<Path>& path_;
  Recording& recording_;
  kernel::Location where_;

  std::unordered_map<uint32_t, Value> values_;
  std::unordered_map<uint32_t, Pointer> pointers_;
  std::unordered_map<uint32_t, Value> variables_;
  struct Product {
    Value a, b;
  };
  std::unordered_map<uint32_t, Product> products_;  // multiplications that wait for the addition that takes them in
  std::unordered_map<uint32_t, std::pair<Scalar, bool>> images_;  // texture record's address; or the picture
  std::set<uint32_t> unseen_;                                     // pictures of which nothing is kept
  std::unordered_map<uint32_t, Value> phis_;                      // declared ones
  std::unordered_map<uint32_t, Value>
      kept_;                       // [id] variables for values that are read behind the loop they are made in
  std::map<uint32_t, int> reach_;  // of labels: predicate of the lanes that have gone there
  std::vector<uint32_t> open_;     // labels that lanes may go to early
  uint32_t current_ = 0;           // block whose lines are recorded, or were last
  int loops_ = 0;
  std::set<uint32_t> written_;  // variables
  bool tag_came_ = false;       // with it
  /// What holds of the lanes of the mask at one place.
  struct Way {
    std::map<std::pair<uint32_t, size_t>, Scalar> known;  // what scalars of variables have been set to
  };
  /// That of lanes from both.
  static Way joined(const std::optional<Way>& a, const Way& b);
  Way way_;
  const Waits* waits_ = nullptr;  // of a shader that waits
  Scalar alive_;
  size_t stores_ = 0;             // imageStores so far
  uint32_t first_word_ = 0;       // of the path's record, for what is held
  std::optional<Scalar> return_;  // register: the site that called the shader
  Value passed_;                  // registers: what has come as a payload, of a shader that has none
  Value callable_data_;           // of a callable shader, as it comes
};

}  // namespace raypool::shader
