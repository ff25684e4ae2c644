#include "tools/height_plot.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace lodestone {
namespace {

CollisionHeights rising() {
  CollisionHeights heights;
  for (int i = 0; i < 16; ++i)
    heights.mean.push_back(0.5f + 0.025f * float(i)), heights.deviation.push_back(0.02f);
  return heights;
}

std::vector<std::string> plot_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// Each column has one mean; the mean of a rising curve never falls from left to right.
TEST(TextPlot, EachColumnHasOneMeanThatRises) {
  const std::vector<std::string> lines = plot_lines(text_plot(rising()));
  ASSERT_EQ(lines.size(), 1U + 15 + 2);
  std::size_t last = 100;
  for (std::size_t column = 8; column < 72; ++column) {
    int means = 0;
    std::size_t row = 0;
    for (std::size_t r = 1; r <= 15; ++r)
      if (column < lines[r].size() && lines[r][column] == '*') ++means, row = r;
    EXPECT_EQ(means, 1) << column;
    EXPECT_LE(row, last);
    last = row;
  }
  for (const std::string& line : lines) {
    EXPECT_LE(line.size(), 100U);
    EXPECT_TRUE(line.empty() || line.back() != ' ');
  }
}

TEST(TextPlot, ADeviationIsAsWideAsItIs) {
  CollisionHeights narrow = rising(), wide = rising();
  for (float& d : wide.deviation) d = 0.2f;
  const std::string a = text_plot(narrow), b = text_plot(wide);
  const auto share = [](const std::string& text) {
    return double(std::ranges::count(text, ':')) / double(std::ranges::count(text, '*'));
  };
  EXPECT_GT(share(b), 3.0 * share(a) + 1.0);
}

// As the names of files may have them; no XML has.
TEST(SvgPlot, WhatIsNoTextIsWrittenOut) {
  const std::string svg = svg_plot(rising(), "a\x1b[31m\xff.obj");
  EXPECT_NE(svg.find("a\\x1b[31m\\xff.obj"), std::string::npos) << svg;
}

TEST(SvgPlot, IsOneDocumentWhosePointsAreInItsFrame) {
  const std::string svg = svg_plot(rising(), "a < b & c");
  EXPECT_TRUE(svg.starts_with("<svg "));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_NE(svg.find("a &lt; b &amp; c"), std::string::npos);
  const std::size_t at = svg.find("<polyline points='") + 18;
  std::istringstream points(svg.substr(at, svg.find('\'', at) - at));
  double x, y, last_x = 0.0, last_y = 1e9;
  char comma;
  int count = 0;
  for (; points >> x >> comma >> y; ++count) {
    EXPECT_GT(x, last_x);
    EXPECT_LT(y, last_y);  // downward in a document
    EXPECT_TRUE(x >= 70 && x <= 610 && y >= 40 && y <= 340) << x << ' ' << y;
    last_x = x, last_y = y;
  }
  EXPECT_EQ(count, 16);
}

TEST(SvgPlot, OneHeightIsAPlotToo) {
  CollisionHeights one;
  one.mean = {1.0f}, one.deviation = {0.0f};
  for (const std::string& text : {svg_plot(one, "ball"), text_plot(one)}) {
    EXPECT_EQ(text.find("nan"), std::string::npos);
    EXPECT_EQ(text.find("inf,"), std::string::npos);
  }
}

}  // namespace
}  // namespace lodestone
