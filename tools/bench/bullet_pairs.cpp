#include "tools/bench/bullet_pairs.h"

#include <utility>

#include "reference/error.h"
#include "reference/geometry.h"

#ifdef LODESTONE_BULLET
#include <btBulletCollisionCommon.h>

namespace lodestone {

struct BulletPairs::Impl {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broad_phase;
  std::vector<btBroadphaseProxy*> boxes;
  bool unbalanced = true;  // as boxes that were put in one after another leave it
  std::vector<float> radii;
  std::span<const double> x, y, z;

  btVector3 corner(std::size_t i, float sign) const {
    const btVector3 half(radii[i], radii[i], radii[i]);
    return (x.empty() ? btVector3(0, 0, 0) : btVector3(btScalar(x[i]), btScalar(y[i]), btScalar(z[i]))) +
           sign * half;
  }
};

BulletPairs::BulletPairs(std::span<const float> radii) : impl_(std::make_unique<Impl>()) {
  impl_->radii.assign(radii.begin(), radii.end());
}

BulletPairs::~BulletPairs() {
  for (btBroadphaseProxy* box : impl_->boxes) impl_->broad_phase.destroyProxy(box, &impl_->dispatcher);
}

void BulletPairs::place(std::span<const double> x, std::span<const double> y, std::span<const double> z) {
  impl_->x = x, impl_->y = y, impl_->z = z;
  const bool fresh = impl_->boxes.empty();
  for (std::size_t i = 0; i < impl_->radii.size(); ++i) {
    const btVector3 low = impl_->corner(i, -1.0f), high = impl_->corner(i, 1.0f);
    if (fresh)
      impl_->boxes.push_back(impl_->broad_phase.createProxy(
          low, high, 0, reinterpret_cast<void*>(std::uintptr_t(i)), 1, 1, &impl_->dispatcher));
    else
      impl_->broad_phase.setAabb(impl_->boxes[i], low, high, &impl_->dispatcher);
  }
}

void BulletPairs::find(std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
  if (std::exchange(impl_->unbalanced, false)) impl_->broad_phase.optimize();
  impl_->broad_phase.calculateOverlappingPairs(&impl_->dispatcher);
  btOverlappingPairCache& kept = *impl_->broad_phase.getOverlappingPairCache();
  const btBroadphasePair* pair = kept.getOverlappingPairArrayPtr();
  const auto number_of = [](const btBroadphaseProxy* box) {
    return std::uint32_t(reinterpret_cast<std::uintptr_t>(box->m_clientObject));
  };
  for (int i = 0; i < kept.getNumOverlappingPairs(); ++i) {
    const std::uint32_t a = number_of(pair[i].m_pProxy0), b = number_of(pair[i].m_pProxy1);
    const double limit = double(impl_->radii[a]) + double(impl_->radii[b]);
    const Vec3 apart(impl_->x[a] - impl_->x[b], impl_->y[a] - impl_->y[b], impl_->z[a] - impl_->z[b]);
    if (apart.squaredNorm() < limit * limit) pairs.emplace_back(a, b);
  }
}

}  // namespace lodestone

#else

namespace lodestone {

struct BulletPairs::Impl {};

BulletPairs::BulletPairs(std::span<const float>) { check_that(false, "this build has Bullet"); }
BulletPairs::~BulletPairs() = default;
void BulletPairs::place(std::span<const double>, std::span<const double>, std::span<const double>) {}
void BulletPairs::find(std::vector<std::pair<std::uint32_t, std::uint32_t>>&) {}

}  // namespace lodestone
#endif
