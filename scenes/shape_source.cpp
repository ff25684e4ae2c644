#include "scenes/shape_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "reference/argument_error.h"
#include "reference/error.h"
#include "reference/mesh/simplified_shapes.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

constexpr std::array kForms{SolidForm{SolidKind::box, "box", "box_m", "X,Y,Z", 3},
                            SolidForm{SolidKind::sphere, "sphere", "sphere_m", "R", 1},
                            SolidForm{SolidKind::l, "l", "l_m", "A,B,W,T", 4},
                            SolidForm{SolidKind::plate, "plate", "plate_m", "X,Y,Z", 3},
                            SolidForm{SolidKind::needle, "needle", "needle_m", "L,R", 2}};

std::string all_forms() {
  std::string text;
  for (const SolidForm& form : kForms) text += fmt::format("{}:{}, ", form.name, form.lengths);
  return text + "bunny or a mesh file (lengths in metres)";
}

std::vector<double> parse_lengths(const std::string& text, const SolidForm& form) {
  std::vector<double> lengths;
  const char* at = text.data() + form.name.size() + 1;
  const char* const end = text.data() + text.size();
  bool more = true;
  while (more) {
    double length = 0;
    const auto [stop, error] = std::from_chars(at, end, length);
    if (error != std::errc() || (stop != end && *stop != ',')) break;
    lengths.push_back(length);
    more = stop != end;
    at = more ? stop + 1 : stop;
  }
  if (more || int(lengths.size()) != form.length_count)
    throw InputError(fmt::format("shape: found {}, expected {}:{} in metres", text, form.name, form.lengths));
  return lengths;
}

void check_lengths(SolidKind kind, std::span<const double> m) {
  const SolidForm& form = kForms[std::size_t(kind)];
  const auto fail = [&](const std::string& expected) {
    throw InputError(fmt::format("{}: found {}, expected {}", form.name, fmt::join(m, ", "), expected));
  };
  if (int(m.size()) != form.length_count)
    fail(fmt::format("{} lengths ({})", form.length_count, form.lengths));
  for (double length : m)
    if (!(length >= 1e-5 && length <= 1e4)) fail("every length in [0.00001, 10000] m");
  if (kind == SolidKind::l && (m[2] >= m[0] || m[2] >= m[1])) fail("a bar width W below both legs A and B");
}

Mesh make_solid_mesh(SolidKind kind, std::span<const double> m) {
  switch (kind) {
    case SolidKind::sphere:
      return make_sphere(m[0]);
    case SolidKind::l:
      return make_l(m[0], m[1], m[2], m[3]);
    case SolidKind::needle:
      return make_needle(m[0], m[1]);
    case SolidKind::box:
    case SolidKind::plate:
      break;
  }
  return make_box({m[0], m[1], m[2]});
}

/// Whether `file` lies in `folder` once symbolic links and `..` are resolved.
bool lies_in(const fs::path& file, const fs::path& folder) {
  const fs::path inner = fs::weakly_canonical(file), outer = fs::weakly_canonical(folder / "");
  const fs::path relative = inner.lexically_relative(outer);
  return !relative.empty() && *relative.begin() != "..";
}

std::vector<fs::path> folders_of(const ShapeOptions& options) {
  return options.search.empty() ? std::vector<fs::path>{"."} : options.search;
}

bool has_override(const MassOverride& mass) { return mass.center_of_mass_m || mass.inertia_per_mass_m2; }

Shape make_bunny(const ShapeOptions& options, const MassOverride& mass) {
  Shape bunny = make_bunny_shape(options.size_m.value_or(0.2), options.faces.value_or(4698));
  if (!has_override(mass)) return bunny;
  Mesh mesh = bunny.mesh;
  for (Vec3& vertex : mesh.vertices) vertex += bunny.center_of_mass_in_mesh;
  return make_shape("bunny", std::move(mesh), mass);
}

}  // namespace

std::span<const SolidForm> solid_forms() { return kForms; }

Shape make_solid(SolidKind kind, std::span<const double> lengths_m, const MassOverride& mass) {
  check_lengths(kind, lengths_m);
  if (kind == SolidKind::sphere && !has_override(mass)) return make_sphere_shape(lengths_m[0]);
  const SolidForm& form = kForms[std::size_t(kind)];
  return make_shape(fmt::format("{}:{}", form.name, fmt::join(lengths_m, ",")),
                    make_solid_mesh(kind, lengths_m), mass);
}

fs::path find_mesh_file(const std::string& name, const ShapeOptions& options) {
  const std::vector<fs::path> folders = folders_of(options);
  std::error_code error;
  for (const fs::path& folder : folders) {
    const fs::path file = folder == "." ? fs::path(name) : folder / name;  // as the user wrote it
    if (options.stay_in_search &&
        std::ranges::none_of(folders, [&](const fs::path& f) { return lies_in(file, f); }))
      throw InputError(fmt::format(
          "found {}, a path out of the scene's folder, expected a file in the folder or in a mesh path",
          name));
    if (fs::is_directory(file, error))
      throw InputError(fmt::format("found {}, a folder, expected a mesh file", name));
    if (fs::is_regular_file(file, error)) return file;
  }
  std::vector<std::string> shown;
  for (const fs::path& folder : folders) shown.push_back(folder.empty() ? "." : folder.string());
  throw InputError(fmt::format("found no {} in {}, expected a mesh file there{}", name,
                               fmt::join(shown, ", "),
                               options.search.empty() ? "" : " (--mesh-path DIR adds a folder)"));
}

Shape make_mesh_shape(const std::string& name, const ShapeOptions& options, const MassOverride& mass,
                      MeshReport* report) {
  if (name == "bunny") return make_bunny(options, mass);
  const fs::path file = find_mesh_file(name, options);
  Mesh mesh = load_mesh(file, {.untrusted = options.untrusted});
  // Scaled before the repair, which judges extents; simplified after it, which needs the faces joined.
  if (options.size_m) mesh = scale_to_size(std::move(mesh), *options.size_m);
  MeshReport first_report;
  mesh = repair_mesh(std::move(mesh), file.string(), report ? report : &first_report);
  if (options.faces && *options.faces < int(mesh.faces.size())) {
    mesh = simplify_mesh(mesh, *options.faces);
    if (options.size_m) mesh = scale_to_size(std::move(mesh), *options.size_m);
  }
  return make_shape(file.filename().string(), std::move(mesh), mass);
}

Shape make_shape_from_text(const std::string& text, const ShapeOptions& options, const MassOverride& mass,
                           MeshReport* report) {
  for (const SolidForm& form : kForms) {
    if (!text.starts_with(fmt::format("{}:", form.name))) continue;
    for (const auto& [name, given] :
         {std::pair("size", options.size_m.has_value()), {"faces", options.faces.has_value()}})
      if (given)
        throw ArgumentError(fmt::format("{}: found it beside {}, expected a mesh there", name, text));
    return make_solid(form.kind, parse_lengths(text, form), mass);
  }
  const bool is_form_without_lengths =
      std::ranges::any_of(kForms, [&](const SolidForm& form) { return form.name == text; });
  if (text.empty() || is_form_without_lengths || (text.find(':') != text.npos && !fs::exists(text)))
    throw InputError(fmt::format("shape: found \"{}\", expected {}", text, all_forms()));
  return make_mesh_shape(text, options, mass, report);
}

}  // namespace lodestone
