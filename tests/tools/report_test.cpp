// `report`: its data, and the page in a browser.
#include "tools/report/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "reference/error.h"
#include "tests/message_of.h"
#include "tests/temporary_folder.h"
#include "tests/tools/browser.h"
#include "tools/compare/drop_report.h"
#include "tools/hard_cases/hard_case_report.h"
#include "tools/report/sections.h"
#include "tools/report/square_heights.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

TEST(ReportTable, ReadsWhatIsWritten) {
  const ReportTable table =
      parse_report_table("t.csv",
                         "# command: build/lodestone a --b\n# command: c\n# commit: 12ab\n# machine: m, 2 "
                         "cores\n# date: 2026-11-21\n"
                         "name,value,flag,list\n\"a, \"\"b\"\"\",-1.5e3,true,1 2\n\"\",,false,ff12\n");
  EXPECT_EQ(table.made.commands, (std::vector<std::string>{"build/lodestone a --b", "c"}));
  EXPECT_EQ(table.made.commit, "12ab");
  EXPECT_EQ(table.made.machine, "m, 2 cores");
  EXPECT_EQ(table.made.date, "2026-11-21");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0],
            (ordered_json{{"name", "a, \"b\""}, {"value", -1500.0}, {"flag", true}, {"list", "1 2"}}));
  EXPECT_EQ(table.rows[1],
            (ordered_json{{"name", ""}, {"value", nullptr}, {"flag", false}, {"list", "ff12"}}));
}

TEST(ReportTable, ReadsWhatTheProgramSaves) {
  const HardCaseResult result = {
      .id = "F1",
      .rows = {{.what = "a \"quoted\" one, with a comma",
                .value = 2.5,
                .bound = 1e-9,
                .unit = "m/s",
                .side = BoundSide::at_least,
                .odes_own = ""},
               {.what = "ODE's", .value = 3.0, .bound = 2.0, .odes_own = "why, and how"}}};
  const testing::TemporaryFolder folder;
  const auto file = folder.at("report.csv");
  save_csv(std::span(&result, 1), file);
  const ReportTable table = parse_report_table("cases", testing::bytes_of(file));
  EXPECT_EQ(table.rows, json_of(std::span(&result, 1))["cases"]);

  DropComparison drops{.shape = "box:1,1,1", .trials = 7};
  drops.truth_substeps = 10;
  drops.floor.value.w_bounces = 0.25;
  DropRow measured{{.method = "statistical", .model = "support", .dt_s = 0.01}};
  measured.score.emplace().interval = {0.25, 0.75};
  measured.ns_per_body_step = 700.0;
  DropRow left_out{{.method = "low", .model = ""}};
  left_out.reason = "has no more than 194 faces";
  drops.rows = {measured, left_out};
  save_scores(drops, file);
  const ReportTable scores = parse_report_table("scores", testing::bytes_of(file));
  ASSERT_EQ(scores.rows.size(), 3u);
  EXPECT_EQ(scores.rows, score_rows_of(drops));
  EXPECT_EQ(scores.rows[0]["method"], "noise_floor");
  EXPECT_EQ(scores.rows[0]["w_bounces"], 0.25);
  EXPECT_EQ(scores.rows[1]["score_to"], 0.75);
  EXPECT_TRUE(scores.rows[2]["score"].is_null());
  EXPECT_EQ(scores.rows[2]["reason"], "has no more than 194 faces");
}

TEST(ReportTable, ALineOfOtherLengthIsNamed) {
  EXPECT_EQ(testing::message_of([] { parse_report_table("t.csv", "# commit: 1\na,b\n1,2\n3\n"); }),
            "t.csv: line 4: found 1 cells, expected 2");
}

// The standard deviation of a height is at most that without spin, .0622.
TEST(SquareHeights, TheExactMeanIsWhatIsMeasured) {
  constexpr int kTrials = 4000;
  for (const double ratio : {0.0, 0.5, 1.9, 2.1, 3.0, 6.0, 20.0, 100.0})
    EXPECT_NEAR(measure_square_height(ratio, kTrials), mean_square_height(ratio),
                4.0 * 0.0622 / std::sqrt(double(kTrials)))
        << ratio;
  EXPECT_DOUBLE_EQ(mean_square_height(2.0), 2.0 / std::numbers::pi);
  EXPECT_NEAR(mean_square_height(2.0 + 1e-9), 2.0 / std::numbers::pi, 1e-6);
  EXPECT_NEAR(mean_square_height(1e6), std::numbers::sqrt2 / 2, 1e-3);
}

ReportSettings without_signatures() {
  ReportSettings settings;
  settings.shapes.clear();
  return settings;
}

const ordered_json* find_row(const ordered_json& rows, std::string_view method, std::string_view model = "") {
  for (const ordered_json& row : rows)
    if (row["method"] == method && (model.empty() || row["model"] == model) &&
        std::abs(row["dt_s"].get<double>() - 1.0 / 60.0) < 1e-4)
      return &row;
  return nullptr;
}

TEST(ReportData, BaselinesSayHowTheyWereMadeAndHoldWhatThePageShows) {
  const ordered_json data = gather_report(without_signatures());
  ASSERT_EQ(data["curve"]["shapes"].size(), 3u);
  for (const ordered_json& shape : data["curve"]["shapes"]) {
    EXPECT_GT(shape["floor"]["score"], 0.0);
    const ordered_json* ours = find_row(shape["rows"], "statistical", "support");
    ASSERT_TRUE(ours);
    EXPECT_NEAR((*ours)["ns_per_frame"].get<double>(), (*ours)["ns_per_body_step"].get<double>(),
                1e-3 * (*ours)["ns_per_frame"].get<double>());  // a frame is such a step
    EXPECT_TRUE(find_row(shape["rows"], "full_1"));
  }
  EXPECT_EQ(data["budget"]["runs"].size(), 4u);
  for (const ordered_json& run : data["budget"]["runs"]) {
    EXPECT_EQ(run["full"].size(), run["processor_ms"].size());
    EXPECT_EQ(int(run["full"].size()) - 9, run["counted_steps"].get<int>());
  }
  const ordered_json& cases = data["hard_cases"];
  EXPECT_EQ(cases["figures"].get<int>(),
            cases["kept"].get<int>() + cases["odes_own"].get<int>() + cases["failed"].get<int>());
  for (const ordered_json* made : {&data["curve"]["shapes"][0]["made"], &data["budget"]["made"],
                                   &data["table1"]["made"], &cases["made"]}) {
    EXPECT_FALSE((*made)["commands"].empty());
    for (const char* key : {"commit", "machine", "date"})
      EXPECT_FALSE((*made)[key].get<std::string>().empty()) << key;
    EXPECT_FALSE((*made)["fresh"].get<bool>());
  }
  EXPECT_FALSE(data["machine"]["commit"].get<std::string>().empty());
}

TEST(ReportData, FreshFiguresAreMarkedAndTakeThePlaceOfTheBaselinesRuns) {
  ReportSettings settings = without_signatures();
  FreshResults fresh;
  fresh.scores.made.fresh = fresh.steps.made.fresh = true;
  const ordered_json floor = {{"shape", "crate"},           {"trials", 30},   {"method", "noise_floor"},
                              {"model", nullptr},           {"dt_s", 0.0005}, {"score", 0.05},
                              {"ns_per_body_step", nullptr}};
  ordered_json row = floor;
  row["method"] = "full_1", row["dt_s"] = 1.0 / 120, row["ns_per_body_step"] = 700.0;
  fresh.scores.rows = {floor, row};
  for (int step = 1; step <= 12; ++step)
    fresh.steps.rows.push_back({{"scene", "s.yaml"},
                                {"budget_ms", 2.0},
                                {"dt_s", 0.01},
                                {"step", step},
                                {"full", 1},
                                {"support", 2},
                                {"tables", 3},
                                {"asleep", 0},
                                {"processor_ms", step < 10 ? 50.0 : step - 9.0}});
  settings.fresh = fresh;
  const ordered_json data = gather_report(settings);
  ASSERT_EQ(data["curve"]["shapes"].size(), 4u);
  EXPECT_EQ(data["curve"]["shapes"][3]["title"], "crate, measured now");
  EXPECT_EQ(data["curve"]["shapes"][3]["floor"]["score"], 0.05);
  EXPECT_DOUBLE_EQ(data["curve"]["shapes"][3]["rows"][0]["ns_per_frame"], 1400.0);
  ASSERT_EQ(data["budget"]["runs"].size(), 1u);
  const ordered_json& run = data["budget"]["runs"][0];
  EXPECT_EQ(run["counted_steps"], 3);  // from the tenth on
  EXPECT_EQ(run["over"], 1);
  EXPECT_EQ(run["max_ms"], 3.0);
  EXPECT_TRUE(data["budget"]["made"]["fresh"].get<bool>());
}

// A run of nine steps: nothing counts, nothing is said of it, and the page has a dash.
TEST(ReportData, ARunThatEndsBeforeItsTenthStepHasNoFigures) {
  ReportSettings settings = without_signatures();
  FreshResults fresh;
  for (int step = 1; step <= 9; ++step)
    fresh.steps.rows.push_back({{"scene", "s.yaml"},
                                {"budget_ms", 2.0},
                                {"dt_s", 0.01},
                                {"step", step},
                                {"full", 1},
                                {"support", 2},
                                {"tables", 3},
                                {"asleep", 0},
                                {"processor_ms", 50.0}});
  settings.fresh = fresh;
  const ordered_json data = gather_report(settings), run = data["budget"]["runs"][0];
  EXPECT_EQ(run["counted_steps"], 0);
  for (const char* figure : {"p50_ms", "p99_ms", "max_ms", "over"})
    EXPECT_TRUE(run[figure].is_null()) << figure;
  for (const ordered_json& fact : data["headline"])
    EXPECT_EQ(fact["text"].get<std::string>().find("s.yaml"), std::string::npos) << fact;
}

// Sentences follow the figures, also where these are bad.
TEST(ReportData, TheHeadlineIsComputed) {
  ordered_json data = gather_report(without_signatures());
  for (ordered_json& shape : data["curve"]["shapes"])
    for (ordered_json& row : shape["rows"]) {
      const bool ours = row["model"] == "support";
      if (ours || row["method"] == "full_1") row["score"] = ours ? 0.1 : 0.4;
      if (ours || row["method"] == "full_plain") row["ns_per_body_step"] = ours ? 500.0 : 250.0;
    }
  const ordered_json facts = headline_section(data);
  EXPECT_EQ(facts[0]["figure"], "4.0 to 4.0 × closer");
  EXPECT_EQ(facts[1]["figure"], "2.0 × dearer");
  EXPECT_NE(facts[1]["text"].get<std::string>().find("500 instead of 250"), std::string::npos);
  for (ordered_json& shape : data["curve"]["shapes"])
    for (ordered_json& row : shape["rows"])
      if (row["model"] == "support") row["score"] = 0.8;
  EXPECT_EQ(headline_section(data)[0]["figure"], "2.00 to 2.00 ×");
}

class ReportSignature : public testing::CliTest {};

TEST_F(ReportSignature, HasHeightsResponsesAndRestPosesOfAShape) {
  const auto ended = run("report --json --shapes box:0.2,0.3,0.4 2>/dev/null");
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const ordered_json signature = ordered_json::parse(ended.out)["signature"];
  const ordered_json& box = signature["shapes"][0];
  double frequency = 0.0;
  for (const ordered_json& pose : box["rest_poses"]) frequency += pose["frequency"].get<double>();
  EXPECT_NEAR(frequency, 1.0, 0.02);
  EXPECT_EQ(box["mesh"]["vertices"].size(), 24u);
  EXPECT_EQ(box["heights"]["mean"].size(), box["heights"]["alpha_deg"].size());
  for (const ordered_json& measure : box["responses"]["measures"]) {
    double share = 0.0;
    for (const ordered_json& bin : measure["trials"])
      share += bin.get<double>() * measure["high"].get<double>() / box["responses"]["bins"].get<double>();
    EXPECT_GT(share, 0.95) << measure["name"];
    EXPECT_LT(share, 1.0 + 1e-3);
    EXPECT_LT(measure["ks"], 0.15) << measure["name"];  // the certificate's for a box is .04
  }
  for (std::size_t i = 0; i < signature["square"]["measured"].size(); ++i)
    EXPECT_LE(signature["square"]["measured"][i][1], 1.0 + 1e-4);
}

// A shape that needs no measuring: a tetrahedron that lies on a face and on its tip.
ordered_json small_signature() {
  const ordered_json measure = {
      {"name", "speed"}, {"high", 1.0}, {"trials", {1.0, 1.0}}, {"draws", {0.5, 1.5}}, {"ks", 0.25}};
  return {{"name", "tetrahedron"},
          {"radius_m", 0.1},
          {"restitution", 0.4},
          {"friction", 0.5},
          {"settling_trials", 10},
          {"heights",
           {{"alpha_deg", {0.0, 45.0, 90.0}}, {"mean", {0.7, 0.8, 1.0}}, {"deviation", {0.1, 0.1, 0.0}}}},
          {"responses",
           {{"trials", 20}, {"conditions", 2}, {"bins", 2}, {"measures", {measure, measure, measure}}}},
          {"rest_poses",
           {{{"normal", {0.0, 0.0, 1.0}}, {"height_over_radius", 0.33}, {"frequency", 0.9}},
            {{"normal", {0.0, 0.0, -1.0}}, {"height_over_radius", 1.0}, {"frequency", 0.1}}}},
          {"mesh",
           {{"vertices", {0.9, 0.0, -0.33, -0.45, 0.8, -0.33, -0.45, -0.8, -0.33, 0.0, 0.0, 1.0}},
            {"faces", {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}}}}};
}

class ReportPage : public ::testing::Test {
 protected:
  ReportPage() {
    data_ = gather_report(without_signatures());
    data_["signature"]["shapes"].push_back(small_signature());
    page_ = make_report(data_);
  }
  ordered_json data_;
  std::string page_;
};

TEST_F(ReportPage, HoldsItsDataAndAsksTheNetworkForNothing) {
  EXPECT_NE(page_.find("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
                       "script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:\">"),
            std::string::npos);
  const ordered_json* ours = find_row(data_["curve"]["shapes"][0]["rows"], "statistical", "support");
  ASSERT_TRUE(ours);
  EXPECT_NE(page_.find((*ours)["score"].dump()), std::string::npos);
  for (const char* request : {"src=\"http", "href=\"http", "url(http", "@import"})
    EXPECT_EQ(page_.find(request), std::string::npos) << request;
  EXPECT_EQ(page_.find("{{"
                       "text:"),
            std::string::npos);
}

std::string value_after(const std::string& said, const std::string& name) {
  const auto at = said.find("\n" + name + " ");
  if (at == std::string::npos) return "";
  const auto begin = at + name.size() + 2;
  return said.substr(begin, said.find('\n', begin) - begin);
}

TEST_F(ReportPage, ItsChartsHoldTheNumbersAndAnswerToKeys) {
  if (!testing::has_browser()) GTEST_SKIP() << "no chromium";
  const std::string said = "\n" + testing::run_in_browser(page_, R"(
    say("ready " + document.body.dataset.ready);
    const canvases = [...document.querySelectorAll("canvas")];
    say("charts " + canvases.filter(canvas => Chart.getChart(canvas)).length + " of " + canvases.length);
    say("labelled " + canvases.filter(canvas => canvas.getAttribute("role") === "img" && canvas.getAttribute("aria-label").length > 40 && canvas.tabIndex === 0).length);
    say("lettered " + canvases.filter(canvas => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.some(value => value)).length);
    const curve = () => Chart.getChart("curve_chart"), support = () => curve().data.datasets.find(line => line.label === "support").data[0];
    say("score " + support().y);
    say("cost " + support().x);
    say("names " + curve().placedLabels.join("|"));
    const press = (canvas, key) => canvas.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true, cancelable: true}));
    const canvas = byId("curve_chart");
    canvas.focus();
    press(canvas, "ArrowRight");
    const first = byId("said").textContent;
    press(canvas, "ArrowRight");
    say("moved " + (first !== byId("said").textContent && curve().getActiveElements().length === 1 && curve().tooltip.opacity > 0));
    say("parts " + scoreParts.every(([, name]) => byId("said").textContent.includes(name)));
    press(canvas, "Escape");
    say("left " + curve().getActiveElements().length);
    const buttons = byId("curve_switch").querySelectorAll("button");
    buttons[2].click();
    say("third " + support().y);
    say("pressed " + [...buttons].map(button => button.getAttribute("aria-pressed")).join(" "));
    const steps = Chart.getChart("steps_chart_0").data.datasets[0].data;
    say("step " + steps[42].ms);
    say("rungs " + Chart.getChart("rungs_chart_0").data.datasets[0].data[42].bodies);
    say("growth " + Chart.getChart("table1_chart").data.datasets.find(line => line.label === "support").data[0].y);
    say("cases " + document.querySelectorAll("#hard_cases_all tbody tr").length);
    say("poses " + [...document.querySelectorAll("#poses img")].map(image => image.naturalWidth).join(" ") + " " + new Set([...document.querySelectorAll("#poses img")].map(image => image.src)).size);
    say("verdicts " + [...document.querySelectorAll("#hard_cases_all td .verdict")].every(verdict => /pass|FAIL|own/.test(verdict.textContent)));
    location.hash = "#only=curve&shape=L";
    await new Promise(done => window.addEventListener("hashchange", done, {once: true}));
    say("alone " + [...document.querySelectorAll("section, header, nav")].filter(part => part.getBoundingClientRect().height > 0).map(part => part.id).join(" ") + ", " + byId("curve_note").textContent.startsWith("The L"));
    redrawCharts();
    say("redrawn " + canvases.filter(canvas => Chart.getChart(canvas)).length);
  )");
  EXPECT_EQ(said.find("ERROR"), std::string::npos) << said;
  EXPECT_EQ(said.find("REQUEST"), std::string::npos) << said;
  EXPECT_EQ(said.find("THROWN"), std::string::npos) << said;
  EXPECT_EQ(value_after(said, "ready"), "yes") << said;
  const int charts = 1 + 2 * 4 + 1 + 2 + 3;
  EXPECT_EQ(value_after(said, "charts"), std::to_string(charts) + " of " + std::to_string(charts)) << said;
  for (const char* name : {"labelled", "lettered", "redrawn"})
    EXPECT_EQ(value_after(said, name), std::to_string(charts)) << name;
  const ordered_json& shapes = data_["curve"]["shapes"];
  EXPECT_DOUBLE_EQ(std::stod(value_after(said, "score")),
                   (*find_row(shapes[0]["rows"], "statistical", "support"))["score"].get<double>());
  EXPECT_DOUBLE_EQ(std::stod(value_after(said, "cost")),
                   (*find_row(shapes[0]["rows"], "statistical", "support"))["ns_per_frame"].get<double>());
  EXPECT_DOUBLE_EQ(std::stod(value_after(said, "third")),
                   (*find_row(shapes[2]["rows"], "statistical", "support"))["score"].get<double>());
  for (const char* name : {"support", "tables", "full", "Bullet hull"})
    EXPECT_NE(value_after(said, "names").find(name), std::string::npos) << name;
  EXPECT_EQ(value_after(said, "moved"), "true");
  EXPECT_EQ(value_after(said, "parts"), "true");
  EXPECT_EQ(value_after(said, "left"), "0");
  EXPECT_EQ(value_after(said, "pressed"), "false false true");
  const ordered_json& first_budget = *std::ranges::find_if(
      data_["budget"]["runs"],
      [](const ordered_json& run) { return !run["budget_ms"].is_null(); });  // which stand first on the page
  EXPECT_DOUBLE_EQ(std::stod(value_after(said, "step")), first_budget["processor_ms"][42].get<double>());
  EXPECT_EQ(std::stoi(value_after(said, "rungs")), first_budget["full"][42].get<int>());
  double support_ms = 0.0;
  for (const ordered_json& row : data_["table1"]["rows"])
    if (support_ms == 0.0 && row["model"] == "support") support_ms = row["step_ms"];
  EXPECT_DOUBLE_EQ(std::stod(value_after(said, "growth")), support_ms);
  EXPECT_EQ(std::stoul(value_after(said, "cases")), data_["hard_cases"]["rows"].size());
  EXPECT_EQ(value_after(said, "poses"), "280 280 2");
  EXPECT_EQ(value_after(said, "verdicts"), "true");
  EXPECT_EQ(value_after(said, "alone"), "curve, true");
}

TEST_F(ReportPage, FitsAPhone) {
  if (!testing::has_browser()) GTEST_SKIP() << "no chromium";
  const std::string said = "\n" + testing::run_in_browser(page_, R"(
    // Chromium's window is no narrower than 500 pixels: a frame of a phone's width in it is.
    document.documentElement.style.width = "390px";
    document.body.style.width = "390px";
    redrawCharts();
    const wide = [...document.querySelectorAll("body *")].filter(element => !element.closest(".scroll, .unseen, .skip, pre") && element.getBoundingClientRect().right > 391 && element.getBoundingClientRect().width > 0);
    say("wide " + wide.length + " " + wide.slice(0, 3).map(element => element.tagName + "#" + element.id + "." + element.className).join(" "));
  )",
                                                          "500,900");
  EXPECT_EQ(value_after(said, "wide").substr(0, 2), "0 ") << said;
}

}  // namespace
}  // namespace lodestone
