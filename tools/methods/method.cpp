#include "tools/methods/method.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "reference/argument_error.h"
#include "reference/drop_trial.h"
#include "tools/terminal.h"

namespace lodestone {
namespace {

constexpr int kLowFaces = 194;  // the paper's low-resolution bunny
constexpr int kSphereCount = 7;

Method make_ode(std::string name, const DropJob& job, OdeMethod way) {
  if (!way.collision_shape) way.collision_shape = job.shape;
  return {std::move(name), std::move(way), ""};
}

// Another mesh about the same centre of mass, with the same mass distribution.
std::shared_ptr<const Shape> make_low_shape(const Shape& shape) {
  const MassOverride mass{.center_of_mass_m = Vec3::Zero(), .inertia_per_mass_m2 = shape.inertia_per_mass};
  return std::make_shared<const Shape>(
      make_shape(shape.name + " low", simplify_mesh(shape.mesh, kLowFaces), mass));
}

// What ODE makes of a mesh over a plane by itself.
OdeSettings plain_settings() { return {.plane_contacts_from_hull = false}; }

// A body is observed for ten seconds, awake.
Method make_full(std::string name, const DropJob& job, int substeps) {
  return make_ode(std::move(name), job,
                  {.substeps = substeps, .settings = ode_settings_of({.sleeping = false})});
}

Method make_low(const DropJob& job) {
  Method method = make_ode("low", job, {.settings = plain_settings()});
  if (job.shape->mesh.faces.size() <= kLowFaces)
    method.left_out = fmt::format("has no more than {} faces", kLowFaces);
  else
    std::get<OdeMethod>(method.way).collision_shape = make_low_shape(*job.shape);
  return method;
}

Method make_bullet(std::string name, const DropJob& job, BulletGeometry geometry) {
  return {std::move(name), BulletMethod{geometry},
          !bullet_available()               ? "needs a build with Bullet (libbullet-dev)"
          : job.ground != DropGround::plane ? "is compared on planes alone"
                                            : ""};
}

using Maker = Method (*)(const DropJob&);
struct NamedMaker {
  std::string_view name;
  Maker make;
};

constexpr std::array<NamedMaker, 11> kEngineMethods = {{
    {"full_plain",
     [](const DropJob& job) { return make_ode("full_plain", job, {.settings = plain_settings()}); }},
    {"full", [](const DropJob& job) { return make_full("full", job, ManagerSettings{}.full_substeps); }},
    {"full_1", [](const DropJob& job) { return make_ode("full_1", job, {}); }},
    {"low", make_low},
    {"spheres7",
     [](const DropJob& job) {
       return make_ode(
           "spheres7", job,
           {.geometry = OdeGeometry::spheres, .spheres = fit_spheres(job.shape->mesh, kSphereCount)});
     }},
    {"sphere", [](const DropJob& job) { return make_ode("sphere", job, {.geometry = OdeGeometry::sphere}); }},
    {"hull",
     [](const DropJob& job) {
       return make_ode("hull", job, {.settings = plain_settings(), .geometry = OdeGeometry::hull});
     }},
    {"bullet_hull", [](const DropJob& job) { return make_bullet("bullet_hull", job, BulletGeometry::hull); }},
    {"bullet_hull40",
     [](const DropJob& job) { return make_bullet("bullet_hull40", job, BulletGeometry::hull40); }},
    {"bullet_sphere",
     [](const DropJob& job) { return make_bullet("bullet_sphere", job, BulletGeometry::sphere); }},
    {"waiting",
     [](const DropJob&) {
       return Method{"waiting", StatisticalMethod{}, ""};
     }},
}};

/// full_2 … full_64: the full level at that many substeps.
std::optional<int> substeps_named(std::string_view name) {
  constexpr std::string_view kPrefix = "full_";
  int substeps = 0;
  if (!name.starts_with(kPrefix)) return {};
  const auto [end, error] =
      std::from_chars(name.data() + kPrefix.size(), name.data() + name.size(), substeps);
  return error == std::errc() && end == name.data() + name.size() && substeps >= 2 && substeps <= 64
             ? std::optional(substeps)
             : std::nullopt;
}

constexpr std::string_view kStatistical = "statistical";

std::vector<Method> make_statistical(const DropJob& job, const SignatureSettings& measuring, int threads,
                                     const Progress& progress) {
  const auto signature = find_signature(job, measuring, threads, progress);
  std::vector<Method> methods;
  for (const auto& [model, published] : {std::pair{StatisticalModel::tables, true},
                                         {StatisticalModel::tables, false},
                                         {StatisticalModel::support, false}})
    methods.push_back({std::string(kStatistical), StatisticalMethod{model, signature, published}, ""});
  return methods;
}

[[noreturn]] void throw_unknown(const std::string& name) {
  throw ArgumentError(
      fmt::format("--methods: found '{}', expected some of {}", name, fmt::join(method_names(), ", ")));
}

}  // namespace

int Method::substeps() const {
  const auto* ode = std::get_if<OdeMethod>(&way);
  return ode ? ode->substeps : 1;
}

std::string Method::model() const {
  const auto* statistical = std::get_if<StatisticalMethod>(&way);
  if (!statistical) return "";
  if (statistical->model == StatisticalModel::support) return "support";
  return statistical->published ? "tables_published" : "tables";
}

void keep_model(std::vector<Method>& methods, const std::string& model) {
  if (!model.empty())
    std::erase_if(methods,
                  [&](const Method& method) { return !method.model().empty() && method.model() != model; });
}

Method with_sleep(Method method, bool sleeping) {
  if (auto* ode = std::get_if<OdeMethod>(&method.way)) ode->settings.auto_disable = sleeping;
  if (auto* bullet = std::get_if<BulletMethod>(&method.way)) bullet->settings.sleeping = sleeping;
  return method;
}

// Small bodies move as fast in their own time, which is the shorter by √λ.
Method make_truth(const DropJob& job, const TruthSettings& settings) {
  const double scale = std::min(1.0, drop_scale(*job.shape));
  OdeMethod truth{.substeps =
                      settings.substeps.value_or(int(std::lround(kTruthSubsteps / std::sqrt(scale))))};
  if (settings.push_m_per_s) truth.settings.max_correcting_velocity = *settings.push_m_per_s;
  return make_ode("truth", job, truth);
}

bool is_method_name(const std::string& name) {
  return substeps_named(name) || std::ranges::count(method_names(), name) > 0;
}

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const NamedMaker& method : kEngineMethods) names.emplace_back(method.name);
  names.emplace_back(kStatistical);
  return names;
}

std::shared_ptr<const Signature> find_signature(const DropJob& job, const SignatureSettings& measuring,
                                                int threads, const Progress& progress) {
  SignatureSourceSettings source;
  source.measuring = measuring;
  source.threads = threads;
  source.progress = progress;
  source.warn = warn;
  return find_or_measure_signature(*job.shape, job.law(), source).signature;
}

std::vector<Method> make_methods(const std::vector<std::string>& names, const DropJob& job,
                                 const SignatureSettings& measuring, int threads, const Progress& progress) {
  std::vector<Method> methods;
  for (const std::string& name : names) {
    if (name == kStatistical) {
      std::ranges::move(make_statistical(job, measuring, threads, progress), std::back_inserter(methods));
      continue;
    }
    if (const auto substeps = substeps_named(name)) {
      methods.push_back(make_full(name, job, *substeps));
      continue;
    }
    const auto found = std::ranges::find(kEngineMethods, name, &NamedMaker::name);
    if (found == kEngineMethods.end()) throw_unknown(name);
    methods.push_back(found->make(job));
  }
  return methods;
}

}  // namespace lodestone
