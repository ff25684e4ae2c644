// What of a manager's settings can change while it runs.
#include <fmt/format.h>

#include "lod/manager/manager_impl.h"
#include "reference/error.h"

namespace lodestone {

void Manager::set_gravity(const Vec3& gravity) {
  check_finite(gravity, "gravity");
  impl_->changes.keep_moved();
  impl_->levels.set_gravity(gravity);
  impl_->recorder.note(Call::set_gravity, gravity);
}

Vec3 Manager::gravity() const { return impl_->levels.statistical_settings.gravity; }

void Manager::set_full_substeps(int substeps) {
  if (substeps < 1) throw_input_error("full_substeps", fmt::to_string(substeps), "1 or more");
  impl_->levels.full.set_substeps(substeps);
  impl_->recorder.note(Call::set_full_substeps, substeps);
}

void Manager::set_threads(int threads) {
  if (threads < 1) throw_input_error("threads", fmt::to_string(threads), "1 or more");
  impl_->levels.statistical_settings.threads = threads;
  if (impl_->levels.statistical) impl_->levels.statistical->set_threads(threads);
  if (!impl_->callers_jobs) *impl_->jobs = make_job_runner(threads);
}

}  // namespace lodestone
