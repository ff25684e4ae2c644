// S2.
#include "lod/contact/contact_impulse.h"
#include "reference/random.h"
#include "tools/bench/response_cases.h"
#include "tools/bench/statistical_case_parts.h"

namespace lodestone {
namespace {

constexpr int kDirections = 1000;

/// How far from orthonormal, right-handed and with the normal for its first axis.
double fault_of(const Mat3& frame, const Vec3& normal) {
  const double skew = (frame.transpose() * frame - Mat3::Identity()).cwiseAbs().maxCoeff();
  const double off = (frame.col(0) - normal).norm(), handed = std::abs(frame.determinant() - 1.0);
  return worse(worse(skew, off), handed);
}

double worst_frame(double tilt) {
  double worst = 0.0;
  for (int i = 0; i < kDirections; ++i) {
    RandomStream random(102, std::uint64_t(i), 0);
    const Vec3 normal = random.direction(), aside = normal.cross(random.direction()).normalized();
    for (const double sign : {-1.0, 1.0})
      for (const double speed : {1e-9, 1.0, 1e9})
        worst = worse(worst, fault_of(contact_frame(normal, speed * (sign * std::cos(tilt) * normal + std::sin(tilt) * aside)), normal));
  }
  return worst;
}

}  // namespace

std::vector<HardCaseRow> measure_contact_frames(const HardCaseSettings&) {
  double tilted = 0.0;
  for (int k = 1; k <= 16; ++k) tilted = worse(tilted, worst_frame(std::pow(10.0, -k)));
  double none = worst_frame(0.0);
  for (const Vec3& normal : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ()), Vec3(-Vec3::UnitZ())})
    for (const Vec3& velocity : {Vec3(Vec3::Zero()), Vec3(-3.0 * normal), Vec3(5e-324 * normal), Vec3(1e-200, 2e-200, 3e-200)})
      none = worse(none, fault_of(contact_frame(normal, velocity), normal));
  return {{.what = "working frame, v tilted by 1e-1 to 1e-16 from +-n: off orthonormal and right-handed", .value = tilted, .bound = 1e-12},
          {.what = "working frame, v along +-n or 0: off orthonormal and right-handed", .value = none, .bound = 1e-12}};
}

}  // namespace lodestone
