#include "tools/view/view_page.h"

#include <fmt/format.h>

#include "scenes/runner.h"
#include "tests/scenes/scene_fixture.h"
#include "tests/tools/browser.h"

namespace lodestone::view_page_test {
namespace {

using testing::has_browser;
using testing::run_in_browser;

const char* const kScene = R"(version: 1
step: {dt_s: 0.02, steps: 50, full_substeps: 2}
shapes: {ball: {sphere_m: 0.1}, crate: {box_m: [0.2, 0.2, 0.3]}}
ground: [{plane: {normal: [0, 0, 1], offset_m: 0}}]
bodies:
  - {shape: crate, position_m: [0, 0, 0.7], velocity_m_per_s: [1, 0, 0], angular_velocity_rad_per_s: [9, 2, 1], name: hero}
  - {shape: ball, position_m: [1, 0, 0.5]}
viewpoints: [{position_m: [0, -3, 1], look_at_m: [0.5, 0, 0.2]}]
lod: {policy: distance, full_within_m: 100}
output: {every_n_steps: 1}
)";

class ViewPage : public SceneFixture {
 protected:
  std::filesystem::path run(const std::string& name, RunSettings settings = {}) {
    settings.out = folder() / name;
    last_ = run_scene(load(kScene), settings);
    return settings.out;
  }
  std::string page(std::vector<std::filesystem::path> runs, bool blind = false) const {
    return make_view_page(runs, blind);
  }
  RunResult last_;
};

const std::string kReady =
    "while (!document.body.dataset.ready && !document.body.dataset.failed) await sleep(50);\nif "
    "(document.body.dataset.failed) say('FAILED ' + document.body.dataset.failed);\n"
    "const key = (name, more = {}) => document.dispatchEvent(new KeyboardEvent('keydown', {key: name, "
    "bubbles: true, ...more}));\n";

TEST_F(ViewPage, IsOneFileWithoutRequests) {
  const std::string text = page({run("a")});
  EXPECT_NE(text.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(text.find("{{"), std::string::npos);
  EXPECT_EQ(text.find("src=\""), std::string::npos);
  EXPECT_EQ(text.find("<link"), std::string::npos);
}

TEST_F(ViewPage, PlaysWhatTheRunWas) {
  if (!has_browser()) GTEST_SKIP() << "no chromium";
  const std::string said = run_in_browser(page({run("a")}), kReady + R"(
    const run = view.runs[0], last = run.frames - 1;
    say([0, 1, 2].map(axis => run.position(last, 0, axis).toFixed(3)).join(" "));
    say(view.runs[0].frames + " frames, " + RUNGS[run.rung(last, 0)] + ", " + run.header.rules[run.rule(last, 0)]);
    view.play(false); view.setTime(0); view.draw();
    const gl = view.renderer.getContext(), pixels = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    const look = () => { gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels); return pixels.slice(); };
    const first = look(), colors = new Set();
    for (let i = 0; i < first.length; i += 4) colors.add(first[i] << 16 | first[i + 1] << 8 | first[i + 2]);
    view.setTime(0.3); view.draw();
    const later = look();
    let moved = 0;
    for (let i = 0; i < later.length; i += 4) moved += later[i] !== first[i];
    say([run.stepMs(0), run.stepMs(run.end()) > 0].join(" "));  // no step ends at 0
    say(colors.size > 20 && moved > 100 ? "picture" : "no picture: " + colors.size + " colours, " + moved + " moved");
  )");
  const Vec3 p = last_.states[0].position;
  EXPECT_EQ(said, fmt::format("{:.3f} {:.3f} {:.3f}\n51 frames, full, near a viewpoint\n true\npicture\n",
                              p.x(), p.y(), p.z() + 0.0));
}

TEST_F(ViewPage, ObeysTheKeyboard) {
  if (!has_browser()) GTEST_SKIP() << "no chromium";
  EXPECT_EQ(run_in_browser(page({run("a")}), kReady + R"(
    key("Home"); view.play(false);
    key("ArrowRight"); say(view.time.toFixed(2));
    key("ArrowRight", {shiftKey: true}); say(view.time.toFixed(2));
    key("ArrowLeft"); say(view.time.toFixed(2));
    key("End"); say(view.time.toFixed(2));
    key(" "); say(view.playing + " " + document.getElementById("play").textContent); key(" ");
    key("c"); say(document.getElementById("camera").value);
    key("h"); say(document.getElementById("solids").getAttribute("aria-pressed"));
    key("n"); view.draw(); say(document.querySelector("#body-facts dd").textContent);
    say(document.querySelectorAll("#history li").length > 0);
  )"),
            "0.02\n0.22\n0.20\n1.00\ntrue Stop\norbit\ntrue\nhero, crate\ntrue\n");
}

TEST_F(ViewPage, ShowsTwoFuturesAndHowFarTheyAreApart) {
  if (!has_browser()) GTEST_SKIP() << "no chromium";
  const std::filesystem::path forked = run("a", {.level = LevelChoice::support, .fork_step = 20});
  const std::string said = run_in_browser(page({forked}), kReady + R"(
    say(view.forks[0].start().toFixed(2));
    const chart = Chart.getChart("difference-chart");
    say(chart.data.datasets[0].data.length + " " + chart.data.datasets[0].data[30].y.toFixed(3));
    view.play(false); view.setTime(0.2); view.draw(); say(view.stages[0].ghostCrowds[0].mesh.visible);
    view.setTime(0.6); view.draw(); say(view.stages[0].ghostCrowds[0].mesh.visible);
    key("g"); view.draw(); say(view.stages[0].ghostCrowds[0].mesh.visible);
  )");
  EXPECT_EQ(said, fmt::format("0.40\n31 {:.3f}\nfalse\ntrue\nfalse\n", last_.fork->mean_distance_m.back()));
}

TEST_F(ViewPage, BlindTestCountsWithAnExactInterval) {
  if (!has_browser()) GTEST_SKIP() << "no chromium";
  const auto runs = std::vector{run("a"), run("b", {.level = LevelChoice::support})};
  EXPECT_EQ(run_in_browser(page(runs, true), kReady + R"(
    say(document.title);
    say(binomialInterval(8, 10).map(x => x.toFixed(4)).join(" "));
    say(binomialInterval(0, 10).map(x => x.toFixed(4)).join(" "));
    for (let i = 0; i < 10; ++i) document.getElementById(view.order[0] === 0 ? "left" : "right").click();
    say(document.getElementById("score").textContent);
    say([...document.querySelectorAll("#labels span")].map(label => label.textContent).join(" "));
  )"),
            "Which of two?\n0.4439 0.9748\n0.0000 0.3085\n10 of 10 right: 100 %, 95 % interval 69 % to 100 "
            "%. You can tell them apart.\nLeft Right\n");
  EXPECT_THROW(make_view_page({runs.data(), 1}, true), InputError);
}

}  // namespace
}  // namespace lodestone::view_page_test
