// Blocks of SPIR-V as code under masks.
#include <algorithm>

#include "shader/lowering.hpp"

namespace raypool::shader {

bool Lowering::is_open(uint32_t label) const { return std::find(open_.begin(), open_.end(), label) != open_.end(); }

size_t Lowering::predecessors(uint32_t label) const {
  size_t count = 0;
  for (const Block& block : module_.blocks()) {
    const std::vector<uint32_t> labels = successors(block);
    count += static_cast<size_t>(std::count(labels.begin(), labels.end(), label));
  }
  return count;
}

/// The cases that lanes of a case fall into, at most.
std::set<uint32_t> Lowering::falls_into(const Module& module, const Block& header, const Case& from,
                                        const std::vector<Case>& cases) {
  const auto is_case = [&](uint32_t label) {
    return std::any_of(cases.begin(), cases.end(), [&](const Case& one) { return one.label == label; });
  };
  std::set<uint32_t> entered, seen;
  std::vector<uint32_t> found = {from.label};
  while (!found.empty()) {
    const uint32_t label = found.back();
    found.pop_back();
    // Outside the switch only its header leads to its cases.
    if (label == header.merge || label == header.label || !seen.insert(label).second) continue;
    for (const uint32_t next : successors(module.block(label))) {
      if (is_case(next))
        entered.insert(next);
      else
        found.push_back(next);
    }
  }
  entered.erase(header.merge);
  entered.erase(from.label);
  return entered;
}

/// In the order of their blocks, but each behind those that fall into it.
std::vector<Lowering::Case> Lowering::cases_of(const Module& module, const Block& header) {
  std::vector<Case> cases;
  const auto entry = [&](uint32_t label) -> Case& {
    for (Case& known : cases)
      if (known.label == label) return known;
    cases.push_back({label, {}, false});
    return cases.back();
  };
  const std::vector<uint32_t>& operands = header.end.operands;
  entry(operands.at(1)).is_default = true;
  for (size_t i = 2; i + 1 < operands.size(); i += 2) entry(operands[i + 1]).literals.push_back(operands[i]);
  std::stable_sort(cases.begin(), cases.end(),
                   [&](const Case& a, const Case& b) { return &module.block(a.label) < &module.block(b.label); });
  std::vector<std::set<uint32_t>> entered;
  for (const Case& one : cases) entered.push_back(falls_into(module, header, one, cases));
  std::vector<Case> ordered;
  std::vector<bool> placed(cases.size(), false);
  const auto waits = [&](uint32_t label) {
    for (size_t i = 0; i < cases.size(); ++i)
      if (!placed[i] && entered[i].count(label) != 0) return true;
    return false;
  };
  while (ordered.size() < cases.size()) {
    size_t next = 0;
    while (next < cases.size() && (placed[next] || waits(cases[next].label))) ++next;
    if (next == cases.size())
      module.fail(header.end.where, "the SPIR-V has cases that fall into each other: make it again");
    placed[next] = true;
    ordered.push_back(cases[next]);
  }
  return ordered;
}

/// Lanes of a case.
Scalar Lowering::matches(const std::vector<Case>& cases, const Case& one, const Scalar& selector) {
  Scalar any = Scalar::constant(0);
  for (const Case& other : cases) {
    if (one.is_default ? other.is_default : other.label != one.label) continue;
    for (const uint32_t literal : other.literals)
      any = either(any, compare(Opcode::Ieq, selector, Scalar::constant(literal)));
  }
  return one.is_default ? inverse(any) : any;
}

namespace {

template <typename Set>
void add(Set& to, const Set& from) {
  to.insert(from.begin(), from.end());
}

}  // namespace

Lowering::Flow Lowering::flow_of_loop(const Block& header) {
  const size_t opened = open_.size();
  open_.push_back(header.merge);
  const bool shared = predecessors(header.continues) > 1 && header.continues != header.label;
  if (shared) open_.push_back(header.continues);
  // As a plain block: its own label is where the body ends.
  Flow body;
  const std::vector<uint32_t>& operands = header.end.operands;
  const auto into = [&](uint32_t label) {
    const Flow part = label == header.label ? Flow{{}, true} : flow(label, header.label);
    add(body.leaves, part.leaves);
    body.falls |= part.falls;
  };
  if (header.end.op == spv::Op::OpBranch) {
    into(operands.at(0));
  } else if (header.end.op == spv::Op::OpBranchConditional) {
    into(operands.at(1));
    into(operands.at(2));
  }
  if (shared) {
    open_.pop_back();
    const Flow rest = flow(header.continues, header.label);
    add(body.leaves, rest.leaves);
  }
  open_.resize(opened);
  Flow whole;
  whole.falls = body.leaves.count(header.merge) != 0;
  whole.leaves = body.leaves;
  whole.leaves.erase(header.merge);
  whole.leaves.erase(header.continues);
  whole.leaves.erase(header.label);
  return whole;
}

Lowering::Flow Lowering::flow_of_switch(const Block& header) {
  const size_t opened = open_.size();
  open_.push_back(header.merge);
  const std::vector<Case> cases = cases_of(module_, header);
  for (const Case& one : cases)
    if (one.label != header.merge) open_.push_back(one.label);
  Flow whole;
  for (const Case& one : cases) {
    if (one.label == header.merge) {
      whole.falls = true;
      continue;
    }
    open_.erase(std::find(open_.begin() + static_cast<std::ptrdiff_t>(opened), open_.end(), one.label));
    const Flow part = flow(one.label, header.merge);
    add(whole.leaves, part.leaves);
    whole.falls |= part.falls;
  }
  open_.resize(opened);
  whole.falls |= whole.leaves.erase(header.merge) != 0;
  for (const Case& one : cases) whole.leaves.erase(one.label);
  return whole;
}

Lowering::Flow Lowering::flow(uint32_t label, uint32_t stop) {
  Flow all;
  while (label != stop) {
    if (is_open(label)) {
      all.leaves.insert(label);
      return all;
    }
    const Block& block = module_.block(label);
    const std::vector<uint32_t>& operands = block.end.operands;
    if (block.continues != 0) {
      const Flow inner = flow_of_loop(block);
      add(all.leaves, inner.leaves);
      if (!inner.falls) return all;
      label = block.merge;
      continue;
    }
    switch (block.end.op) {
      case spv::Op::OpBranch:
        label = operands.at(0);
        continue;
      case spv::Op::OpBranchConditional: {
        const uint32_t end = block.merge != 0 ? block.merge : stop;
        const Flow a = flow(operands.at(1), end), b = flow(operands.at(2), end);
        add(all.leaves, a.leaves);
        add(all.leaves, b.leaves);
        if (!a.falls && !b.falls) return all;
        label = end;
        continue;
      }
      case spv::Op::OpSwitch: {
        const Flow inner = flow_of_switch(block);
        add(all.leaves, inner.leaves);
        if (!inner.falls) return all;
        label = block.merge;
        continue;
      }
      case spv::Op::OpUnreachable:
        return all;
      default:
        all.leaves.insert(kEnd);
        return all;
    }
  }
  all.falls = true;
  return all;
}

void Lowering::under(const Scalar& chosen, const std::function<void()>& body) {
  if (chosen.is_constant()) {
    if (chosen.bits != 0) body();
    return;
  }
  recorder_.begin_if(condition(chosen));
  body();
  recorder_.end_if();
}

Lowering::Way Lowering::joined(const std::optional<Way>& a, const Way& b) {
  if (!a) return b;
  Way both = *a;
  for (auto entry = both.known.begin(); entry != both.known.end();) {
    const auto other = b.known.find(entry->first);
    const bool same = other != b.known.end() && other->second == entry->second;
    entry = same ? std::next(entry) : both.known.erase(entry);
  }
  return both;
}

void Lowering::lines(const Block& block) { lines(block, 0, block.lines.size()); }

void Lowering::lines(const Block& block, size_t first, size_t end) {
  current_ = block.label;
  if (first == 0)
    for (const Line& phi : block.phis)
      if (kept_.count(phi.id) != 0) set(phi, get(phi.id));
  for (size_t i = first; i < end; ++i) {
    const Line& line = block.lines[i];
    // What all lanes have computed already stays: those that come back behind a trace would not have it from here.
    if (waits_ != nullptr && waits_->is_steady(line)) continue;
    where_ = line.where;
    recorder_.set_place(where_);
    operation(line);
  }
  where_ = block.end.where;
  recorder_.set_place(where_);
}

void Lowering::declare_phis(uint32_t label) {
  if (label == kEnd) return;
  for (const Line& phi : module_.block(label).phis) {
    Value value(module_.scalars(phi.type));
    for (uint32_t i = 0; i < value.size(); ++i) value[i] = declare(is_condition(phi.type, i));
    phis_[phi.id] = value;
    values_[phi.id] = value;
  }
}

Value Lowering::incoming(const Line& phi, uint32_t from) {
  for (size_t i = 0; i + 1 < phi.operands.size(); i += 2)
    if (phi.operands[i + 1] == from) return get(phi.operands[i]);
  fail("the SPIR-V has a phi without a value for one of its branches: make it again");
}

void Lowering::edge(uint32_t from, uint32_t to) {
  if (to != kEnd && to != kIgnored) {
    const Block& target = module_.block(to);
    // All are read before one is written.
    std::vector<std::pair<Scalar*, Scalar>> moves;
    for (const Line& phi : target.phis) {
      const auto declared = phis_.find(phi.id);
      const Value value = incoming(phi, from);
      if (declared == phis_.end()) {
        if (predecessors(to) == 1) values_[phi.id] = value;
        continue;
      }
      for (size_t i = 0; i < value.size(); ++i)
        if (!(declared->second[i] == value[i])) moves.emplace_back(&declared->second[i], value[i]);
    }
    for (size_t i = 1; i < moves.size(); ++i) {
      for (size_t k = 0; k < i; ++k) {
        if (moves[i].second.kind != moves[k].first->kind || moves[i].second.number != moves[k].first->number) continue;
        moves[i].second = copy(moves[i].second);
      }
    }
    for (auto& [variable, source] : moves) assign(*variable, source);
  }
  const auto reached = reach_.find(to);
  if (reached != reach_.end()) recorder_.join(reached->second);
}

void Lowering::continue_at(uint32_t merge, uint32_t stop, bool masked) {
  if (!masked) {
    region(merge, stop);
    return;
  }
  const int lanes = reach_.at(merge);
  reach_.erase(merge);
  under(Scalar::in_predicate(lanes), [&] { region(merge, stop); });
}

void Lowering::go(uint32_t from, uint32_t to, uint32_t stop) {
  const bool enters = to != stop && !is_open(to);
  if (enters && module_.block(to).continues != 0) declare_phis(to);
  edge(from, to);
  if (enters) region(to, stop);
}

void Lowering::region(uint32_t label, uint32_t stop) {
  while (label != stop && !is_open(label)) {
    const Block& block = module_.block(label);
    const std::vector<uint32_t>& operands = block.end.operands;
    if (block.continues != 0 && std::find(open_.begin(), open_.end(), block.merge) == open_.end()) {
      loop(block, stop);
      return;
    }
    lines(block);
    switch (block.end.op) {
      case spv::Op::OpBranch: {
        const uint32_t next = operands.at(0);
        if (next != stop && !is_open(next) && module_.block(next).continues != 0) declare_phis(next);
        edge(label, next);
        label = next;
        continue;
      }
      case spv::Op::OpBranchConditional:
        if (block.merge != 0 && block.continues == 0)
          selection(block, stop);
        else
          unmerged_branch(block, stop);
        return;
      case spv::Op::OpSwitch:
        switch_over(block, stop);
        return;
      case spv::Op::OpReturn:
      case spv::Op::OpTerminateRayKHR:
        edge(label, kEnd);
        return;
      case spv::Op::OpUnreachable:
        return;
      case spv::Op::OpIgnoreIntersectionKHR:
        edge(label, kIgnored);
        return;
      default:
        fail("main() ends with a value: it must return void");
    }
  }
}

void Lowering::select_phis(const Block& merge, const Scalar& chosen, uint32_t from_then, uint32_t from_else) {
  for (const Line& phi : merge.phis) {
    const Value a = incoming(phi, from_then), b = incoming(phi, from_else);
    values_[phi.id] = select(phi.type, {chosen}, a, b);
  }
}

bool Lowering::known_selection(const Block& block, uint32_t taken, uint32_t stop) {
  const uint32_t merge = block.merge;
  // The merge has a value from this side alone.
  const Flow side = flow(taken, merge);
  if (!side.leaves.empty() || merge == stop || is_open(merge)) return false;
  uint32_t from = block.label;
  if (taken != merge) {
    go(block.label, taken, merge);
    from = current_;
  }
  if (side.falls) {
    for (const Line& phi : module_.block(merge).phis) values_[phi.id] = incoming(phi, from);
    region(merge, stop);
  }
  return true;
}

void Lowering::declare_arms(size_t begin, int first_register, const Block& merge, const std::array<uint32_t, 2>& from) {
  std::set<int> of_arms;
  for (const Line& phi : merge.phis)
    for (const uint32_t arm : from)
      for (const Scalar& scalar : incoming(phi, arm))
        if (scalar.kind == Scalar::Kind::Register && scalar.number >= first_register) of_arms.insert(scalar.number);
  recorder_.declare_before(begin, {of_arms.begin(), of_arms.end()});
}

void Lowering::selection(const Block& block, uint32_t stop) {
  const uint32_t merge = block.merge, yes = block.end.operands.at(1), no = block.end.operands.at(2);
  const Scalar chosen = get_scalar(block.end.operands.at(0));
  if (chosen.is_constant() && known_selection(block, chosen.bits != 0 ? yes : no, stop)) return;
  const Way before = way_;
  const Flow then_flow = flow(yes, merge), else_flow = flow(no, merge);
  const bool leaves = !then_flow.leaves.empty() || !else_flow.leaves.empty();
  const bool falls = then_flow.falls || else_flow.falls;
  const bool merge_is_inner = merge != stop && !is_open(merge);
  const bool by_selection = !leaves && then_flow.falls && else_flow.falls && merge_is_inner;
  const bool masked = leaves && falls && merge_is_inner;
  if (masked) reach_[merge] = recorder_.declare_predicate();
  if (!by_selection && falls && merge_is_inner) declare_phis(merge);

  std::optional<Way> after;
  const size_t begin = recorder_.ops();
  const int first_register = recorder_.registers();
  uint32_t from_then = block.label, from_else = block.label;
  const auto arm = [&](uint32_t label, const Flow& its, uint32_t& from) {
    way_ = before;
    if (by_selection) {
      if (label != merge) {
        go(block.label, label, merge);
        from = current_;
      }
    } else {
      go(block.label, label, merge);
    }
    if (its.falls) after = joined(after, way_);
  };
  // Nothing is to be done on a side that is the merge itself, unless masks or phis change there.
  const auto is_idle = [&](uint32_t label) {
    return label == merge && (by_selection || (!masked && reach_.count(merge) == 0 && !has_phis(merge)));
  };
  if (is_idle(yes) && is_idle(no)) {
    after = before;
  } else if (chosen.is_constant()) {
    // No lane takes the other side, which may have what is not supported.
    chosen.bits != 0 ? arm(yes, then_flow, from_then) : arm(no, else_flow, from_else);
  } else if (is_idle(yes)) {
    under(inverse(chosen), [&] { arm(no, else_flow, from_else); });
    arm(yes, {{}, true}, from_then);
  } else if (is_idle(no)) {
    under(chosen, [&] { arm(yes, then_flow, from_then); });
    arm(no, {{}, true}, from_else);
  } else {
    recorder_.begin_if(condition(chosen));
    arm(yes, then_flow, from_then);
    recorder_.begin_else();
    arm(no, else_flow, from_else);
    recorder_.end_if();
  }
  way_ = after.value_or(before);
  if (!falls || !merge_is_inner) return;
  if (by_selection) {
    declare_arms(begin, first_register, module_.block(merge), {from_then, from_else});
    select_phis(module_.block(merge), chosen, from_then, from_else);
  }
  continue_at(merge, stop, masked);
}

void Lowering::unmerged_branch(const Block& block, uint32_t stop) {
  const uint32_t yes = block.end.operands.at(1), no = block.end.operands.at(2);
  const Scalar chosen = get_scalar(block.end.operands.at(0));
  const Way before = way_;
  std::optional<Way> after;
  const auto side = [&](const Scalar& which, uint32_t label) {
    if (which == Scalar::constant(0)) return;
    const bool idle = (label == stop || is_open(label)) && reach_.count(label) == 0 && !has_phis(label);
    way_ = before;
    if (!idle) under(which, [&] { go(block.label, label, stop); });
    after = joined(after, way_);
  };
  // Lanes that leave go first: the others' values may replace what they take along.
  const bool no_first = no == stop || is_open(no);
  if (no_first) side(inverse(chosen), no);
  side(chosen, yes);
  if (!no_first) side(inverse(chosen), no);
  way_ = *after;
}

/// The blocks that are recorded in the loop.
std::set<uint32_t> Lowering::blocks_within(const Block& header, uint32_t stop) const {
  std::set<uint32_t> within;
  std::vector<uint32_t> found = {header.label};
  while (!found.empty()) {
    const uint32_t label = found.back();
    found.pop_back();
    const bool ends = label == stop || label == header.merge || is_open(label) || reach_.count(label) != 0;
    if ((ends && label != header.label) || !within.insert(label).second) continue;
    for (const uint32_t next : successors(module_.block(label))) found.push_back(next);
  }
  return within;
}

/// Lanes that have left a loop go without a value that its later rounds compute: code behind the loop reads it from a
/// variable, which keeps theirs.
void Lowering::keep_beyond(const Block& header, uint32_t stop) {
  const std::set<uint32_t> within = blocks_within(header, stop);
  std::set<uint32_t> read;  // outside
  for (const Block& block : module_.blocks()) {
    if (within.count(block.label) != 0) continue;
    for (const Line& phi : block.phis)
      for (size_t i = 0; i + 1 < phi.operands.size(); i += 2)
        if (within.count(phi.operands[i + 1]) == 0) read.insert(phi.operands[i]);
    for (const Line& line : block.lines) read.insert(line.operands.begin(), line.operands.end());
    read.insert(block.end.operands.begin(), block.end.operands.end());
  }
  const auto keep_one = [&](const Line& line) {
    const bool is_new = line.type != 0 && read.count(line.id) != 0 && kept_.count(line.id) == 0;
    if (!is_new) return false;
    Value& variable = kept_[line.id];
    const uint32_t size = module_.scalars(line.type);
    for (uint32_t i = 0; i < size; ++i) variable.push_back(declare(is_condition(line.type, i)));
    if (size != 0) return true;
    // A pointer or an image: what it is made of, or an address that is loaded.
    read.insert(line.operands.begin(), line.operands.end());
    variable.push_back(declare(false));
    return true;
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (const uint32_t label : within) {
      const Block& block = module_.block(label);
      if (label != header.label)
        for (const Line& phi : block.phis) changed |= keep_one(phi);
      for (const Line& line : block.lines) changed |= keep_one(line);
    }
  }
}

void Lowering::loop(const Block& header, uint32_t stop) {
  keep_beyond(header, stop);
  const Flow whole = flow_of_loop(header);
  const bool leaves = !whole.leaves.empty();
  const bool shared = predecessors(header.continues) > 1 && header.continues != header.label;
  const uint32_t merge = header.merge;
  const bool merge_is_inner = merge != stop && !is_open(merge);
  const bool masked = leaves && whole.falls && merge_is_inner;
  if (masked) reach_[merge] = recorder_.declare_predicate();
  if (whole.falls && merge_is_inner) declare_phis(merge);
  // An entry block may be a header.
  for (const Line& phi : header.phis)
    if (phis_.count(phi.id) == 0) fail("the SPIR-V enters a loop in a way that is not supported: make it again");

  way_.known.clear();
  const int again = recorder_.emit_predicates(Opcode::Pand, 0, 0, where_);
  recorder_.begin_loop(again, where_);
  ++loops_;
  const size_t opened = open_.size();
  open_.push_back(merge);
  const int next = recorder_.declare_predicate();
  reach_[header.label] = next;
  if (shared) {
    open_.push_back(header.continues);
    reach_[header.continues] = recorder_.declare_predicate();
    declare_phis(header.continues);
  }
  // The header as a plain block.
  lines(header);
  const std::vector<uint32_t>& operands = header.end.operands;
  if (header.end.op == spv::Op::OpBranch) {
    go(header.label, operands.at(0), header.label);
  } else if (header.end.op == spv::Op::OpBranchConditional) {
    unmerged_branch(header, header.label);
  } else {
    fail("a loop begins with a switch, which is not supported: put a statement before it");
  }
  if (shared) {
    open_.pop_back();
    const int lanes = reach_.at(header.continues);
    reach_.erase(header.continues);
    way_.known.clear();
    under(Scalar::in_predicate(lanes), [&] { region(header.continues, header.label); });
  }
  open_.resize(opened);
  reach_.erase(header.label);
  --loops_;
  recorder_.end_loop(next, false);
  way_.known.clear();
  if (!whole.falls) return;
  if (!merge_is_inner) return;
  continue_at(merge, stop, masked);
}

void Lowering::switch_over(const Block& header, uint32_t stop) {
  const uint32_t merge = header.merge;
  const Flow whole = flow_of_switch(header);
  const bool merge_is_inner = merge != stop && !is_open(merge);
  const bool masked = !whole.leaves.empty() && whole.falls && merge_is_inner;
  if (masked) reach_[merge] = recorder_.declare_predicate();
  if (whole.falls && merge_is_inner) declare_phis(merge);
  const Scalar selector = get_scalar(header.end.operands.at(0));
  const std::vector<Case> cases = cases_of(module_, header);
  const size_t opened = open_.size();
  open_.push_back(merge);
  for (const Case& one : cases) {
    if (one.label == merge) continue;
    open_.push_back(one.label);
    // Its phis have a value of the switch's own block and of the case that falls into it.
    if (predecessors(one.label) > 1) {
      reach_[one.label] = recorder_.declare_predicate();
      declare_phis(one.label);
    }
  }
  const Way before = way_;
  Way after = way_;
  for (const Case& one : cases) {
    const Scalar chosen = matches(cases, one, selector);
    if (one.label == merge) {
      if (reach_.count(merge) != 0 || has_phis(merge)) under(chosen, [&] { edge(header.label, merge); });
      continue;
    }
    Scalar enters = chosen;
    const bool shared = reach_.count(one.label) != 0;
    if (shared) {
      under(chosen, [&] { edge(header.label, one.label); });
      enters = Scalar::in_predicate(reach_.at(one.label));
      reach_.erase(one.label);
    } else {
      // It has but this predecessor, and its phis this value.
      for (const Line& phi : module_.block(one.label).phis) values_[phi.id] = incoming(phi, header.label);
    }
    open_.erase(std::find(open_.begin() + static_cast<std::ptrdiff_t>(opened), open_.end(), one.label));
    way_ = shared ? after : before;  // lanes may come from the case before
    way_.known.clear();
    under(enters, [&] { region(one.label, merge); });
    after = joined(after, way_);
  }
  open_.resize(opened);
  way_ = after;
  way_.known.clear();
  if (whole.falls && merge_is_inner) continue_at(merge, stop, masked);
}

}  // namespace raypool::shader
