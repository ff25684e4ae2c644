#include "tools/height_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

#include "tools/terminal.h"

namespace lodestone {
namespace {

constexpr double kQuarterTurn = std::numbers::pi / 2;

struct Tick {
  double ratio;  // R‖ω‖/‖v‖
  std::string_view text;
};
constexpr std::array<Tick, 6> kTicks{
    {{0.0, "0"}, {0.5, "0.5"}, {1.0, "1"}, {2.0, "2"}, {5.0, "5"}, {1e300, "inf"}}};

// Of the width.
double place_of(const Tick& tick) { return std::atan(tick.ratio) / kQuarterTurn; }

struct Range {
  double low = 1e300, high = -1e300;
};

// Rounded outward to twentieths, so that the axis has short numbers.
Range range_of(const CollisionHeights& heights) {
  Range range;
  for (std::size_t i = 0; i < heights.mean.size(); ++i) {
    range.low = std::min(range.low, double(heights.mean[i] - heights.deviation[i]));
    range.high = std::max(range.high, double(heights.mean[i] + heights.deviation[i]));
  }
  return {std::floor(range.low * 20.0 - 0.1) / 20.0, std::ceil(range.high * 20.0 + 0.1) / 20.0};
}

constexpr int kColumns = 64, kRows = 15;

std::vector<std::string> draw_rows(const CollisionHeights& heights, const Range& range) {
  std::vector<std::string> rows(kRows, std::string(kColumns, ' '));
  const auto row_of = [&](double height) {
    return std::clamp(int(std::lround((range.high - height) / (range.high - range.low) * (kRows - 1))), 0,
                      kRows - 1);
  };
  for (int column = 0; column < kColumns; ++column) {
    const HeightStatistics h = find_collision_height(heights, kQuarterTurn * column / (kColumns - 1));
    for (int row = row_of(h.mean + h.deviation); row <= row_of(h.mean - h.deviation); ++row)
      rows[std::size_t(row)][std::size_t(column)] = ':';
    rows[std::size_t(row_of(h.mean))][std::size_t(column)] = '*';
  }
  return rows;
}

// XML takes neither control characters nor what is no UTF-8.
std::string escaped_svg(const std::string& text) {
  std::string out;
  for (const char c : printable(text)) {
    if (c == '<')
      out += "&lt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

constexpr double kLeft = 70, kTop = 40, kWidth = 540, kHeight = 300;

// From shares of the plot, up and to the right, to the document.
struct Canvas {
  Range range;
  double x(double part) const { return kLeft + kWidth * part; }
  double y(double height) const { return kTop + kHeight * (range.high - height) / (range.high - range.low); }

  std::string curve(const CollisionHeights& heights, double deviations, bool backwards) const {
    std::string points;
    const int n = int(heights.mean.size());
    for (int i = 0; i < n; ++i) {
      const auto k = std::size_t(backwards ? n - 1 - i : i);
      points += fmt::format("{:.1f},{:.1f} ", x(n > 1 ? double(k) / (n - 1) : 0.0),
                            y(heights.mean[k] + deviations * heights.deviation[k]));
    }
    return points;
  }

  std::string axes() const {
    std::string svg;
    for (const Tick& tick : kTicks)
      svg += fmt::format(
          "<line x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}' stroke='#ddd'/><text x='{0:.1f}' y='{3}' "
          "text-anchor='middle'>{4}</text>\n",
          x(place_of(tick)), kTop, kTop + kHeight, kTop + kHeight + 18, tick.ratio > 1e9 ? "∞" : tick.text);
    for (int i = 0; i <= 5; ++i) {
      const double height = range.low + (range.high - range.low) * i / 5;
      svg += fmt::format(
          "<line x1='{0}' x2='{1}' y1='{2:.1f}' y2='{2:.1f}' stroke='#ddd'/><text x='{3}' y='{4:.1f}' "
          "text-anchor='end'>{5:.2f}</text>\n",
          kLeft, kLeft + kWidth, y(height), kLeft - 8, y(height) + 4, height);
    }
    return svg;
  }
};

}  // namespace

std::string text_plot(const CollisionHeights& heights) {
  const Range range = range_of(heights);
  const std::vector<std::string> rows = draw_rows(heights, range);
  std::string text = "collision height over R (mean *, deviation :)\n";
  for (int row = 0; row < kRows; ++row) {
    const bool labelled = row % ((kRows - 1) / 2) == 0;
    const double height = range.high - (range.high - range.low) * row / (kRows - 1);
    text += (labelled ? fmt::format("{:6.3f} |", height) : std::string("       |")) + rows[std::size_t(row)];
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  text += "       +" + std::string(kColumns, '-') + "\n";
  std::string ticks(8 + kColumns + 4, ' ');
  for (const Tick& tick : kTicks)
    ticks.replace(8 + std::size_t(std::lround(place_of(tick) * (kColumns - 1))), tick.text.size(), tick.text);
  return text + ticks.substr(0, ticks.find_last_not_of(' ') + 1) + "   R x spin / speed\n";
}

std::string svg_plot(const CollisionHeights& heights, const std::string& title) {
  const Canvas canvas{range_of(heights)};
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='640' height='400' font-family='sans-serif' "
      "font-size='13'>\n"
      "<rect width='640' height='400' fill='white'/>\n<text x='{}' y='24' font-size='15'>{}</text>\n",
      kLeft, escaped_svg(title));
  svg += canvas.axes();
  svg += fmt::format("<polygon points='{}{}' fill='#4477aa' fill-opacity='0.25'/>\n",
                     canvas.curve(heights, 1.0, false), canvas.curve(heights, -1.0, true));
  svg += fmt::format("<polyline points='{}' fill='none' stroke='#4477aa' stroke-width='2'/>\n",
                     canvas.curve(heights, 0.0, false));
  svg += fmt::format("<text x='{}' y='385' text-anchor='middle'>R‖ω‖ / ‖v‖</text>\n", kLeft + kWidth / 2);
  svg += fmt::format(
      "<text transform='translate(20 {}) rotate(-90)' text-anchor='middle'>collision height / "
      "R</text>\n</svg>\n",
      kTop + kHeight / 2);
  return svg;
}

}  // namespace lodestone
