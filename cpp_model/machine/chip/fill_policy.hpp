// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// The policy `fill`, ours, for large machines: it waits for full loads, keeps a kernel ready behind the one that runs,
// and looks at what a kernel will produce and at what waits at the ports. docs/machine/controller.md has its rules and
// what they give.
#pragma once

#include <cstdint>

#include "machine/chip/kernel_policy.hpp"

namespace raypool {

class FillPolicy : public KernelPolicy {
 public:
  explicit FillPolicy(const PolicySetup& setup);
  Choice choose(const PolicyView& view) const override;

  uint32_t load() const { return load_; }
  uint32_t backlog() const { return backlog_; }

 private:
  uint32_t ray_room(const PolicyView& view) const;
  Choice full_load(const PolicyView& view, const Choice& secondary, const Choice& shade) const;
  Choice part_load(const PolicyView& view, const Choice& secondary, const Choice& shade) const;
  bool behind(const PolicyView& view) const { return view.rays > backlog_; }

  PolicySetup setup_;
  uint32_t load_;     // so many intersections are worth a kernel
  uint32_t backlog_;  // with more rays in their pool the traverser is behind
};

}  // namespace raypool
