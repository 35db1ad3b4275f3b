#include "chip/ledger_controller.hpp"

#include <stdexcept>

#include "bits.hpp"

namespace raypool::chip {

LedgerController::LedgerController(const sc_core::sc_module_name& name, const ChipOptions& options)
    : Controller(name, options),
      policy_(policy_of(options)),
      rules_(chip_, options.configuration.contents(), options.device->units()) {
  SC_METHOD(decide);
  sensitive << decide_;
  dont_initialize();
}

bool LedgerController::eye_possible() const {
  return !next_tile_.at_end() && rules_.may_cast(next_tile_.tile().pixels, ledger->held());
}

PolicyView LedgerController::view(bool ahead) const {
  const PoolLevels seen = levels();
  PolicyView view = seen.view(ledger->rays_to_come());
  view.secondary_room = rules_.secondary_room(seen.shadow_rays, ledger->shadow_rays_to_come(), view.shadow);
  view.kernels = kernels_.under_way();
  view.eye_possible = eye_possible();
  view.ahead = ahead;
  return view;
}

void LedgerController::decide() {
  clock->guard([&] {
    if (next_tile_.at_end() && ledger->held() == 0 && device->idle()) {
      finish();
      return;
    }
    if (!device->can_launch()) return;
    const bool ahead = device->busy(device->next_unit());
    if (ahead && !chip_.launch_ahead) return;
    const PolicyView seen = view(ahead);
    const Choice choice = policy_->choose(seen);
    if (choice.kind != Choice::Kind::Halt) launch(choice, seen);
  });
}

void LedgerController::launch(const Choice& choice, const PolicyView& seen) {
  if (choice.kind == Choice::Kind::Eye) {
    if (!seen.eye_possible) throw std::logic_error("the policy casts eye rays that must not be cast now");
    const uint32_t held = ledger->held();
    rules_.cast(held);
    cast(held);
    return;
  }
  const bool shade = choice.kind == Choice::Kind::Shade;
  const ImportKind kind = shade ? ImportKind::Shadow : levels().secondary_import();
  const RayKernel kernel = shade                        ? RayKernel::Shade
                           : kind == ImportKind::Direct ? RayKernel::CastSecondaryDirect
                                                        : secondary_;
  if (choice.threads == 0 || choice.threads > (shade ? seen.shadow : seen.normal) ||
      choice.threads > options_.configuration.contents() || (!shade && choice.threads > seen.secondary_room)) {
    throw std::logic_error("the policy launches a kernel of a size that is not possible now");
  }
  import(kernel, kind, choice.threads);
}

}  // namespace raypool::chip
