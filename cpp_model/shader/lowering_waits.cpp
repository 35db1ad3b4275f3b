// Shaders that wait for their rays. A traceRayEXT sends the ray and ends the thread; when the ray comes back, another
// thread enters the shader's code behind the trace, with what the path's record holds.
#include <algorithm>

#include "shader/lowering.hpp"

namespace raypool::shader {

void Lowering::wait(const Line& line) {
  const TraceSite& site = *waits_->site(line);
  where_ = line.where;
  recorder_.set_place(where_);
  // A ray that is too deep is not traced: the shader goes on at once.
  Scalar stays = Scalar::constant(0), sends = alive_;
  if (waits_on_a_level()) {
    const Scalar deep = compare(Opcode::Uge, *path_->level, Scalar::constant(resources_.levels));
    stays = copy(both(alive_, deep));
    sends = both(alive_, inverse(deep));
  }
  under(sends, [&] { send(line, site); });
  if (!path_->comes_back) {
    alive_ = Scalar::in_predicate(recorder_.declare_predicate());  // no lane is
    return;
  }
  alive_ = compare(Opcode::Ieq, path_->site, Scalar::constant(site.number));
  under(alive_, [&] { go_on(site); });
  alive_ = either(alive_, stays);
}

std::set<uint32_t> Lowering::sites_from(uint32_t label, uint32_t stop) const {
  std::set<uint32_t> sites, seen;
  std::vector<uint32_t> found = {label};
  while (!found.empty()) {
    const uint32_t at = found.back();
    found.pop_back();
    if (at == stop || at == kEnd || is_open(at) || reach_.count(at) != 0 || !seen.insert(at).second) continue;
    for (const TraceSite& site : waits_->sites)
      if (site.block == at) sites.insert(site.number);
    for (const uint32_t next : successors(module_.block(at))) found.push_back(next);
  }
  return sites;
}

Scalar Lowering::coming(const std::set<uint32_t>& sites) {
  Scalar any = Scalar::constant(0);
  if (!path_->comes_back) return any;
  for (const uint32_t site : sites) any = either(any, compare(Opcode::Ieq, path_->site, Scalar::constant(site)));
  return any;
}

void Lowering::waiting_lines(const Block& block) {
  const auto part = [&](size_t first, size_t end) {
    way_ = {};
    under(alive_, [&] {
      lines(block, first, end);
      flush_products();
    });
  };
  size_t begin = 0;
  for (size_t i = 0; i < block.lines.size(); ++i) {
    if (block.lines[i].op != spv::Op::OpTraceRayKHR) continue;
    part(begin, i);
    wait(block.lines[i]);
    begin = i + 1;
    if (begin == block.lines.size()) current_ = block.label;
  }
  if (begin < block.lines.size() || begin == 0) part(begin, block.lines.size());
}

/// Lanes go from one block to another, and on from there; others of the mask may wait for traces there.
void Lowering::waiting_go(uint32_t from, uint32_t to, uint32_t stop) {
  const bool enters = to != stop && !is_open(to);
  if (enters && module_.block(to).continues != 0) declare_phis(to);
  under(alive_, [&] { edge(from, to); });
  if (enters) waiting_region(to, stop);
}

void Lowering::waiting_side(const Scalar& chosen, uint32_t from, uint32_t to, uint32_t stop) {
  const Scalar before = alive_;
  const bool enters = to != stop && !is_open(to);
  const Scalar its = both(before, chosen);
  if (its == Scalar::constant(0)) return;  // no lane sends a ray from there, so none comes back to it
  const Scalar mask = enters ? either(its, coming(sites_from(to, stop))) : its;
  under(mask, [&] {
    alive_ = its;
    waiting_go(from, to, stop);
  });
  alive_ = before;
}

void Lowering::waiting_sides(const Block& block, uint32_t stop) {
  const uint32_t yes = block.end.operands.at(1), no = block.end.operands.at(2);
  const Scalar chosen = get_scalar(block.end.operands.at(0));
  // Lanes that leave go first: the others' values may replace what they take along.
  const bool no_first = no == stop || is_open(no);
  if (no_first) waiting_side(inverse(chosen), block.label, no, stop);
  waiting_side(chosen, block.label, yes, stop);
  if (!no_first) waiting_side(inverse(chosen), block.label, no, stop);
}

void Lowering::waiting_loop(const Block& header) {
  keep_beyond(header, header.merge);
  for (const Line& phi : header.phis)
    if (phis_.count(phi.id) == 0) fail("the SPIR-V enters a loop in a way that is not supported: make it again");
  const bool shared = predecessors(header.continues) > 1 && header.continues != header.label;
  const int again = predicate(copy(either(alive_, coming(sites_from(header.label, header.merge)))));
  const Scalar here = copy(alive_);
  recorder_.begin_loop(again, where_);
  ++loops_;
  const int next = recorder_.declare_predicate();
  reach_[header.label] = next;
  if (shared) {
    open_.push_back(header.continues);
    reach_[header.continues] = recorder_.declare_predicate();
    declare_phis(header.continues);
  }
  alive_ = here;
  waiting_lines(header);
  if (header.end.op == spv::Op::OpBranch) {
    waiting_go(header.label, header.end.operands.at(0), header.label);
  } else if (header.end.op == spv::Op::OpBranchConditional) {
    waiting_sides(header, header.label);
  } else {
    fail("a loop begins with a switch, which is not supported: put a statement before it");
  }
  if (shared) {
    open_.pop_back();
    alive_ = Scalar::in_predicate(reach_.at(header.continues));
    reach_.erase(header.continues);
    waiting_inner(header.continues, header.label);
  }
  reach_.erase(header.label);
  --loops_;
  recorder_.assign_predicate(here.number, next, false);
  recorder_.end_loop(next, false);
}

void Lowering::waiting_switch(const Block& header) {
  const Scalar selector = get_scalar(header.end.operands.at(0)), before = alive_;
  const std::vector<Case> cases = cases_of(module_, header);
  const size_t opened = open_.size();
  for (const Case& one : cases) {
    if (one.label == header.merge) continue;
    open_.push_back(one.label);
    reach_[one.label] = recorder_.declare_predicate();
    declare_phis(one.label);
  }
  for (const Case& one : cases) {
    alive_ = before;
    under(both(before, matches(cases, one, selector)), [&] { edge(header.label, one.label); });
    if (one.label == header.merge) continue;
    alive_ = Scalar::in_predicate(reach_.at(one.label));
    reach_.erase(one.label);
    open_.erase(std::find(open_.begin() + static_cast<std::ptrdiff_t>(opened), open_.end(), one.label));
    waiting_inner(one.label, header.merge);
  }
  open_.resize(opened);
}

/// A region that lanes are in already, and others of the mask may come to.
void Lowering::waiting_inner(uint32_t label, uint32_t stop) {
  const Scalar its = alive_;
  under(either(its, coming(sites_from(label, stop))), [&] { waiting_region(label, stop); });
  alive_ = its;
}

void Lowering::waiting_construct(const Block& block, uint32_t stop) {
  const bool is_loop = block.continues != 0;
  std::set<uint32_t> inside;
  if (is_loop) inside = sites_from(block.label, block.merge);
  for (const uint32_t next : successors(block)) {
    const std::set<uint32_t> its = sites_from(next, block.merge);
    inside.insert(its.begin(), its.end());
  }
  if (inside.empty()) {
    way_ = {};
    under(alive_, [&] {
      if (is_loop)
        loop(block, stop);
      else if (block.end.op == spv::Op::OpSwitch)
        switch_over(block, stop);
      else
        selection(block, stop);
    });
  } else if (is_loop) {
    waiting_loop(block);
  } else if (block.end.op == spv::Op::OpSwitch) {
    waiting_switch(block);
  } else {
    waiting_sides(block, block.merge);
  }
}

void Lowering::waiting_region(uint32_t label, uint32_t stop) {
  while (label != stop && !is_open(label)) {
    if (sites_from(label, stop).empty()) {
      way_ = {};
      under(alive_, [&] { region(label, stop); });
      return;
    }
    const Block& block = module_.block(label);
    const bool is_loop = block.continues != 0 && std::find(open_.begin(), open_.end(), block.merge) == open_.end();
    if (!is_loop) waiting_lines(block);
    if (is_loop || (block.merge != 0 && block.continues == 0)) {
      // Lanes that come to the merge are in its predicate.
      const uint32_t merge = block.merge;
      const bool is_inner = merge != stop && !is_open(merge);
      if (is_inner) {
        reach_[merge] = recorder_.declare_predicate();
        declare_phis(merge);
        open_.push_back(merge);
      }
      waiting_construct(block, stop);
      if (!is_inner) return;
      open_.pop_back();
      alive_ = Scalar::in_predicate(reach_.at(merge));
      reach_.erase(merge);
      label = merge;
      continue;
    }
    switch (block.end.op) {
      case spv::Op::OpBranch: {
        const uint32_t next = block.end.operands.at(0);
        if (next != stop && !is_open(next) && module_.block(next).continues != 0) declare_phis(next);
        under(alive_, [&] { edge(label, next); });
        label = next;
        continue;
      }
      case spv::Op::OpBranchConditional:
        waiting_sides(block, stop);
        return;
      case spv::Op::OpReturn:
        under(alive_, [&] { edge(label, kEnd); });
        return;
      case spv::Op::OpUnreachable:
        return;
      default:
        fail("main() ends in a way that is not supported here");
    }
  }
}

}  // namespace raypool::shader
