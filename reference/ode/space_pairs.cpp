#include "reference/ode/space_pairs.h"

#include "reference/ode/runtime_ode.h"

namespace lodestone {

struct OdeSpacePairs::Impl {
  dSpaceID space = nullptr;
  std::vector<dGeomID> balls;
  std::vector<double> radii;
  std::span<const double> x, y, z;
  std::vector<std::pair<std::uint32_t, std::uint32_t>>* found = nullptr;

  static std::uint32_t number_of(dGeomID ball) {
    return std::uint32_t(reinterpret_cast<std::uintptr_t>(dGeomGetData(ball)));
  }
  void meet(std::uint32_t a, std::uint32_t b) const {
    const double limit = radii[a] + radii[b];
    if (Vec3(x[a] - x[b], y[a] - y[b], z[a] - z[b]).squaredNorm() < limit * limit) found->emplace_back(a, b);
  }
};

OdeSpacePairs::OdeSpacePairs(OdeSpaceKind kind, std::span<const float> radii)
    : impl_(std::make_unique<Impl>()) {
  ode::prepare();
  impl_->space = kind == OdeSpaceKind::hash ? dHashSpaceCreate(nullptr)
                                            : dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ);
  for (const float radius : radii) {
    const dGeomID ball = dCreateSphere(impl_->space, double(radius));
    dGeomSetData(ball, reinterpret_cast<void*>(std::uintptr_t(impl_->balls.size())));
    impl_->balls.push_back(ball);
    impl_->radii.push_back(double(radius));
  }
}

OdeSpacePairs::~OdeSpacePairs() {
  dSpaceSetCleanup(impl_->space, 0);
  for (std::size_t i = impl_->balls.size(); i-- > 0;) dGeomDestroy(impl_->balls[i]);
  dSpaceDestroy(impl_->space);
}

void OdeSpacePairs::place(std::span<const double> x, std::span<const double> y, std::span<const double> z) {
  impl_->x = x, impl_->y = y, impl_->z = z;
  for (std::size_t i = 0; i < impl_->balls.size(); ++i) dGeomSetPosition(impl_->balls[i], x[i], y[i], z[i]);
}

void OdeSpacePairs::find(std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
  impl_->found = &pairs;
  const auto meet = [](void* impl, dGeomID a, dGeomID b) {
    static_cast<const Impl*>(impl)->meet(Impl::number_of(a), Impl::number_of(b));
  };
  dSpaceCollide(impl_->space, impl_.get(), meet);
}

}  // namespace lodestone
