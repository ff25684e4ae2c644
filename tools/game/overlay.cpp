#include "tools/game/overlay.h"

#include <SDL_opengl.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>

namespace game {
namespace {

using namespace lodestone;

using Glyph = std::array<std::uint8_t, 5>;  // columns from the left, bit 0 on top

// From the space to Z.
constexpr std::array<Glyph, 59> kGlyphs{
    {{0x00, 0x00, 0x00, 0x00, 0x00}, {0x00, 0x00, 0x5F, 0x00, 0x00}, {0x00, 0x07, 0x00, 0x07, 0x00},
     {0x14, 0x7F, 0x14, 0x7F, 0x14}, {0x24, 0x2A, 0x7F, 0x2A, 0x12}, {0x23, 0x13, 0x08, 0x64, 0x62},
     {0x36, 0x49, 0x55, 0x22, 0x50}, {0x00, 0x00, 0x07, 0x00, 0x00}, {0x00, 0x1C, 0x22, 0x41, 0x00},
     {0x00, 0x41, 0x22, 0x1C, 0x00}, {0x14, 0x08, 0x3E, 0x08, 0x14}, {0x08, 0x08, 0x3E, 0x08, 0x08},
     {0x00, 0x50, 0x30, 0x00, 0x00}, {0x08, 0x08, 0x08, 0x08, 0x08}, {0x00, 0x60, 0x60, 0x00, 0x00},
     {0x20, 0x10, 0x08, 0x04, 0x02}, {0x3E, 0x51, 0x49, 0x45, 0x3E}, {0x00, 0x42, 0x7F, 0x40, 0x00},
     {0x42, 0x61, 0x51, 0x49, 0x46}, {0x21, 0x41, 0x45, 0x4B, 0x31}, {0x18, 0x14, 0x12, 0x7F, 0x10},
     {0x27, 0x45, 0x45, 0x45, 0x39}, {0x3C, 0x4A, 0x49, 0x49, 0x30}, {0x01, 0x71, 0x09, 0x05, 0x03},
     {0x36, 0x49, 0x49, 0x49, 0x36}, {0x06, 0x49, 0x49, 0x29, 0x1E}, {0x00, 0x36, 0x36, 0x00, 0x00},
     {0x00, 0x56, 0x36, 0x00, 0x00}, {0x08, 0x14, 0x22, 0x41, 0x00}, {0x14, 0x14, 0x14, 0x14, 0x14},
     {0x00, 0x41, 0x22, 0x14, 0x08}, {0x02, 0x01, 0x51, 0x09, 0x06}, {0x32, 0x49, 0x79, 0x41, 0x3E},
     {0x7E, 0x11, 0x11, 0x11, 0x7E}, {0x7F, 0x49, 0x49, 0x49, 0x36}, {0x3E, 0x41, 0x41, 0x41, 0x22},
     {0x7F, 0x41, 0x41, 0x22, 0x1C}, {0x7F, 0x49, 0x49, 0x49, 0x41}, {0x7F, 0x09, 0x09, 0x09, 0x01},
     {0x3E, 0x41, 0x49, 0x49, 0x7A}, {0x7F, 0x08, 0x08, 0x08, 0x7F}, {0x00, 0x41, 0x7F, 0x41, 0x00},
     {0x20, 0x40, 0x41, 0x3F, 0x01}, {0x7F, 0x08, 0x14, 0x22, 0x41}, {0x7F, 0x40, 0x40, 0x40, 0x40},
     {0x7F, 0x02, 0x0C, 0x02, 0x7F}, {0x7F, 0x04, 0x08, 0x10, 0x7F}, {0x3E, 0x41, 0x41, 0x41, 0x3E},
     {0x7F, 0x09, 0x09, 0x09, 0x06}, {0x3E, 0x41, 0x51, 0x21, 0x5E}, {0x7F, 0x09, 0x19, 0x29, 0x46},
     {0x46, 0x49, 0x49, 0x49, 0x31}, {0x01, 0x01, 0x7F, 0x01, 0x01}, {0x3F, 0x40, 0x40, 0x40, 0x3F},
     {0x1F, 0x20, 0x40, 0x20, 0x1F}, {0x3F, 0x40, 0x38, 0x40, 0x3F}, {0x63, 0x14, 0x08, 0x14, 0x63},
     {0x07, 0x08, 0x70, 0x08, 0x07}, {0x61, 0x51, 0x49, 0x45, 0x43}}};
constexpr float kDot = 2.0f, kAdvance = 6.0f * kDot;  // pixels

void fill(float x, float y, float width, float height) {
  glBegin(GL_QUADS);
  glVertex2f(x, y), glVertex2f(x, y + height), glVertex2f(x + width, y + height), glVertex2f(x + width, y);
  glEnd();
}

// In capitals; x and y of the upper left corner. Returns where the next text begins.
float write(const std::string& text, float x, float y) {
  glBegin(GL_QUADS);
  for (const char letter : text) {
    const int index = std::toupper(static_cast<unsigned char>(letter)) - ' ';
    if (index >= 0 && index < int(kGlyphs.size()))
      for (int bit = 0; bit < 35; ++bit)
        if (kGlyphs[index][bit / 7] >> (bit % 7) & 1) {
          const float left = x + kDot * float(bit / 7), top = y + kDot * float(bit % 7);
          glVertex2f(left, top), glVertex2f(left, top + kDot), glVertex2f(left + kDot, top + kDot),
              glVertex2f(left + kDot, top);
        }
    x += kAdvance;
  }
  glEnd();
  return x;
}

template <class... Values>
std::string printed(const char* format, Values... values) {
  char line[160];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

void color_of(Rung rung) {
  const DebugColor& color = kRungColors[std::size_t(rung)];
  glColor3f(color.red, color.green, color.blue);
}

constexpr float kLeft = 22.0f, kBarWidth = 420.0f;

// The rungs' shares of what the step took, under a budget, then what is no rung's.
void draw_bar(const OverlayState& state, float y, float full_scale_ms) {
  const auto pixels = [&](double ms) { return std::min(float(ms) / full_scale_ms, 1.0f) * kBarWidth; };
  glColor3f(0.20f, 0.22f, 0.25f);
  fill(kLeft, y, kBarWidth, 18.0f);
  glColor3f(0.75f, 0.75f, 0.75f);
  fill(kLeft, y, pixels(state.spent_ms), 18.0f);
  double from = 0.0;
  for (const Rung rung : {Rung::full, Rung::support, Rung::tables}) {
    const double to = std::min(from + state.report.cost[std::size_t(rung)].measured_ms, state.spent_ms);
    color_of(rung);
    fill(kLeft + pixels(from), y, pixels(to) - pixels(from), 18.0f);
    from = to;
  }
  if (state.budget_ms <= 0.0) return;
  glColor3f(1.0f, 1.0f, 1.0f);
  fill(kLeft + pixels(state.budget_ms) - 1.0f, y - 4.0f, 3.0f, 26.0f);
}

// What the last frames took, the newest on the right; the budget as a line.
void draw_curve(const OverlayState& state, float y, float full_scale_ms) {
  constexpr float kHeight = 44.0f;
  constexpr int kFrames = 210;
  const auto top_of = [&](double ms) {
    return y + kHeight * (1.0f - std::min(float(ms) / full_scale_ms, 1.0f));
  };
  glColor3f(0.20f, 0.22f, 0.25f);
  fill(kLeft, y, kBarWidth, kHeight);
  const int count = std::min<int>(kFrames, int(state.history_ms.size()));
  for (int i = 0; i < count; ++i) {
    const double ms = state.history_ms[state.history_ms.size() - std::size_t(count) + std::size_t(i)];
    const bool over = state.budget_ms > 0.0 && ms > state.budget_ms;
    glColor3f(over ? 0.95f : 0.60f, over ? 0.30f : 0.75f, over ? 0.25f : 0.60f);
    const float top = top_of(ms);
    fill(kLeft + kBarWidth - 2.0f * float(count - i), top, 2.0f, y + kHeight - top);
  }
  if (state.budget_ms <= 0.0) return;
  glColor3f(1.0f, 1.0f, 1.0f);
  fill(kLeft, top_of(state.budget_ms), kBarWidth, 1.0f);
}

void draw_figures(const OverlayState& state, float y) {
  glColor3f(1.0f, 1.0f, 1.0f);
  write(state.policy, kLeft, y);
  write(printed("step %5.2f ms", state.spent_ms) + (state.paused ? "  paused" : ""), kLeft, y + 22.0f);
  float x = kLeft;
  const StepReport& report = state.report;
  for (const auto& [rung, count] :
       {std::pair(Rung::full, report.full), std::pair(Rung::support, report.support),
        std::pair(Rung::tables, report.tables)}) {
    color_of(rung);
    fill(x, y + 46.0f, 10.0f, 14.0f);
    glColor3f(1.0f, 1.0f, 1.0f);
    x = write(printed("%s %d", std::string(name_of(rung)).c_str(), count), x + 16.0f, y + 46.0f) + 14.0f;
  }
  write(printed("asleep %d  up %d  down %d", report.asleep, report.promotions, report.demotions), kLeft,
        y + 68.0f);
}

void draw_keys(int height) {
  glColor4f(0.05f, 0.06f, 0.08f, 0.65f);
  fill(10.0f, float(height) - 56.0f, 1010.0f, 48.0f);
  glColor3f(0.85f, 0.85f, 0.85f);
  write("wasd q e fly   mouse arrows look   space throw   r ragdoll   p pause   h hulls", 22.0f,
        float(height) - 50.0f);
  write("1 distance   2 budget   3 error budget   4 size   + - more less   esc end", 22.0f,
        float(height) - 28.0f);
}

}  // namespace

void draw_overlay(const OverlayState& state, int width, int height) {
  glPushAttrib(GL_ALL_ATTRIB_BITS);
  glDisable(GL_DEPTH_TEST), glDisable(GL_LIGHTING), glDisable(GL_FOG), glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND), glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glMatrixMode(GL_PROJECTION), glPushMatrix(), glLoadIdentity();
  glOrtho(0, width, height, 0, -1, 1);
  glMatrixMode(GL_MODELVIEW), glPushMatrix(), glLoadIdentity();

  const float full_scale_ms = state.budget_ms > 0.0 ? 2.0f * float(state.budget_ms) : 8.0f;
  glColor4f(0.05f, 0.06f, 0.08f, 0.65f);
  fill(10.0f, 10.0f, kBarWidth + 24.0f, 188.0f);
  draw_figures(state, 20.0f);
  draw_bar(state, 114.0f, full_scale_ms);
  draw_curve(state, 144.0f, full_scale_ms);
  draw_keys(height);

  glPopMatrix(), glMatrixMode(GL_PROJECTION), glPopMatrix();
  glPopAttrib();
}

}  // namespace game
