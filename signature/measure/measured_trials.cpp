#include "signature/measure/measured_trials.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>

#include "reference/error.h"
#include "signature/file_bytes.h"

namespace lodestone {
namespace {

constexpr std::string_view kHeading =
    "kind,vx_before_m_per_s,vy_before_m_per_s,vz_before_m_per_s,wx_before_rad_per_s,wy_before_rad_per_s,wz_"
    "before_rad_per_s,nx,ny,nz,"
    "vx_after_m_per_s,vy_after_m_per_s,vz_after_m_per_s,wx_after_rad_per_s,wy_after_rad_per_s,wz_after_rad_"
    "per_s";
constexpr std::size_t kColumns = 16, kNormal = 7;

// Where an error is: the file and the line.
struct Place {
  const std::string& file;
  int line;
  [[noreturn]] void fail(std::string_view found, std::string_view expected) const {
    throw InputError(fmt::format("{}:{}: found {}, expected {}", file, line, found, expected));
  }
};

std::array<std::string_view, kColumns> split(std::string_view row, const Place& place) {
  std::array<std::string_view, kColumns> cells;
  for (std::size_t i = 0; i < kColumns; ++i) {
    const std::size_t comma = row.find(',');
    cells[i] = row.substr(0, comma);
    if ((comma == std::string_view::npos) != (i + 1 == kColumns))
      place.fail("a row of another length", fmt::format("{} columns", kColumns));
    if (comma != std::string_view::npos) row.remove_prefix(comma + 1);
  }
  return cells;
}

Vec3 vector_from(const std::array<std::string_view, kColumns>& cells, std::size_t first, const Place& place) {
  Vec3 v;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string_view cell = cells[first + i];
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), v[Eigen::Index(i)]);
    if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(v[Eigen::Index(i)]))
      place.fail(fmt::format("'{}' in column {}", cell, first + i + 1), "a finite number");
  }
  return v;
}

Vec3 normal_from(const std::array<std::string_view, kColumns>& cells, const Place& place) {
  const Vec3 normal = vector_from(cells, kNormal, place);
  if (!(std::abs(normal.norm() - 1.0) <= 1e-3))
    place.fail(fmt::format("a normal of length {}", normal.norm()), "unit length");
  return normal.normalized();
}

void add_row(std::string_view row, const Place& place, MeasuredTrials& trials) {
  const auto cells = split(row, place);
  if (cells[0] == "rest") {
    for (std::size_t i = 1; i < kColumns; ++i)
      if ((i < kNormal || i >= kNormal + 3) && !cells[i].empty())
        place.fail(fmt::format("'{}' in column {} of a rest", cells[i], i + 1), "nothing but a normal");
    trials.rest_normals.push_back(normal_from(cells, place));
  } else if (cells[0] == "collision") {
    trials.collisions.push_back({vector_from(cells, 1, place), vector_from(cells, 4, place),
                                 normal_from(cells, place), vector_from(cells, 10, place),
                                 vector_from(cells, 13, place)});
  } else {
    place.fail(fmt::format("'{}' in column 1", cells[0]), "collision or rest");
  }
}

std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

void append(std::string& to, const Vec3& v) {
  fmt::format_to(std::back_inserter(to), ",{},{},{}", v.x(), v.y(), v.z());
}

}  // namespace

MeasuredTrials load_trials(const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::vector<std::byte> bytes = read_file(file, "a CSV file of measured trials");
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  MeasuredTrials trials;
  Place place{name, 1};
  if (const std::string_view heading = take_line(text); heading != kHeading)
    place.fail(fmt::format("'{}'", heading.substr(0, 60)), fmt::format("the heading '{}'", kHeading));
  for (++place.line; !text.empty(); ++place.line)
    if (const std::string_view row = take_line(text); !row.empty()) add_row(row, place, trials);
  if (trials.collisions.empty() && trials.rest_normals.empty()) place.fail("no row", "at least one");
  return trials;
}

void save_trials(const MeasuredTrials& trials, const std::filesystem::path& file) {
  std::string text(kHeading);
  text += '\n';
  for (const MeasuredCollision& c : trials.collisions) {
    text += "collision";
    for (const Vec3& v :
         {c.velocity_before, c.angular_velocity_before, c.normal, c.velocity_after, c.angular_velocity_after})
      append(text, v);
    text += '\n';
  }
  for (const Vec3& normal : trials.rest_normals) {
    text += "rest,,,,,,";
    append(text, normal);
    text += ",,,,,,\n";
  }
  write_atomically(std::as_bytes(std::span(text)), file);
}

}  // namespace lodestone
