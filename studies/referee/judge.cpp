#include "referee/judge.hpp"

#include <algorithm>
#include <cmath>

namespace raypool::referee {
namespace {

constexpr double kNever = 0x1p1000;  // no t is as large

}  // namespace

const char* name_of(Fault fault) {
  constexpr const char* kNames[kFaults] = {"false hit", "lost hit", "wrong triangle", "crack"};
  return kNames[static_cast<size_t>(fault)];
}

double error_of(float t, const Meeting& meeting) {
  if (!std::isfinite(t)) return INFINITY;
  const int exponent = meeting.nearest == 0 ? -126 : std::isinf(meeting.nearest) ? 127 : std::ilogb(meeting.nearest);
  const double unit = std::ldexp(1.0, std::max(exponent, -126) - 23);
  return std::fabs(((Exact(t) - meeting.t) / Exact(unit)).approximately());
}

bool stops_rays_beside(const HitCase& hit_case, const Exact& t) {
  float largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    largest = std::max(largest, std::fabs(hit_case.ray.origin[axis]));
    for (const auto& corners : hit_case.triangles) {
      for (const Vec3& corner : corners) largest = std::max(largest, std::fabs(corner[axis]));
    }
  }
  const float beside = std::max(largest * 0x1p-20f, 0x1p-149f);
  const Vec3& direction = hit_case.ray.direction;
  int along = 0;
  for (const int axis : {1, 2}) along = std::fabs(direction[axis]) > std::fabs(direction[along]) ? axis : along;
  for (int place = 0; place < 9; ++place) {
    HitCase moved = hit_case;
    moved.ray.origin[(along + 1) % 3] += static_cast<float>(place % 3 - 1) * beside;
    moved.ray.origin[(along + 2) % 3] += static_cast<float>(place / 3 - 1) * beside;
    const Certificate certificate = certify(moved);
    if (certificate.miss || !(certificate.hidden_from < t)) return false;
  }
  return true;
}

Verdict judge(const HitCase& hit_case, const Certificate& certificate, const HitAnswer& answer) {
  Verdict verdict;
  const auto set = [&](Fault fault) {
    verdict.faults[static_cast<size_t>(fault)] = true;
    verdict.right = false;
  };
  if (answer.hit && certificate.allows(answer.triangle)) {
    verdict.timed = true;
    verdict.error = error_of(answer.t, *certificate.meeting(answer.triangle));
    return verdict;
  }
  if (!answer.hit && certificate.miss) return verdict;
  if (!answer.hit) {
    set(Fault::LostHit);
  } else {
    set(certificate.allowed.empty() ? Fault::FalseHit : Fault::WrongTriangle);
  }
  if (certificate.miss) return verdict;
  const Meeting* const met = answer.hit ? certificate.meeting(answer.triangle) : nullptr;
  const bool goes_on = !answer.hit || (met != nullptr && certificate.hidden_from < met->t);
  if (goes_on && stops_rays_beside(hit_case, met != nullptr ? met->t : Exact(kNever))) set(Fault::Crack);
  return verdict;
}

}  // namespace raypool::referee
