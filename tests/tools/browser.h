// A page of HTML in headless Chromium: loaded, run, and asked what came of it.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "tests/tools/cli_fixture.h"

namespace lodestone::testing {

/// Whether Debian's chromium is installed; a test that needs it is skipped otherwise.
inline bool has_browser() { return std::system("command -v chromium >/dev/null 2>&1") == 0; }

/// In the page: what happens before its first script. Errors are kept where `test_script` finds them, as
/// `errors`, and so are requests, as `requests`.
inline constexpr std::string_view kBeforePage = R"(<script>
window.test = {errors: [], requests: [], out: ""};
window.addEventListener("error", event => test.errors.push(event.message || "a resource failed"), true);
window.addEventListener("unhandledrejection", event => test.errors.push(String(event.reason)));
window.addEventListener("securitypolicyviolation", event => test.requests.push(event.blockedURI));
</script>
)";

/// After its last: `test_script` is the body of an async function with `errors` (of the page so far),
/// `requests` (that its policy forbade) and `say(text)`, which adds a line to what run_in_browser returns.
/// What it throws is added, too. The script's end must not depend on more than 20 s of the page's own time.
inline std::string after_page(const std::string& test_script) {
  return R"(<script>
window.addEventListener("load", () => setTimeout(async () => {
  const {errors, requests} = test, say = text => { test.out += text + "\n"; };
  const sleep = ms => new Promise(done => setTimeout(done, ms));
  try {
)" + test_script +
         R"(
  } catch (error) { say("THROWN " + error.message); }
  for (const error of errors) say("ERROR " + error);
  for (const request of requests) say("REQUEST " + request);
  window.requestAnimationFrame = () => 0;  // nothing more is drawn in what is left of the page's time
  const result = document.createElement("pre");
  result.id = "test-result";
  result.textContent = "[begin]" + test.out + "[end]";
  document.body.appendChild(result);
}, 0));
</script>
)";
}

/// The lines that `test_script` said of `page`, then a line "ERROR …" for each error of the page's scripts,
/// "REQUEST …" for each request that its policy forbade and "THROWN …" where the test itself threw. "&", "<"
/// and ">" come as the entities that HTML writes. Without an end, what Chromium said. `window_size` in CSS
/// pixels: "1280,900".
inline std::string run_in_browser(const std::string& page, const std::string& test_script,
                                  const std::string& window_size = "1280,900") {
  const TemporaryFolder own;
  const std::filesystem::path& folder = own.path();
  std::string tested = page;
  const auto head = tested.find("<head>");
  tested.insert(head == std::string::npos ? 0 : head + 6, kBeforePage);
  const auto end = tested.rfind("</body>");
  tested.insert(end == std::string::npos ? tested.size() : end, after_page(test_script));
  std::ofstream(folder / "page.html", std::ios::binary) << tested;
  const Ended ended = run_shell(
      "timeout 120 chromium --headless --no-sandbox --disable-gpu-sandbox --use-gl=angle "
      "--use-angle=swiftshader --enable-unsafe-swiftshader --hide-scrollbars "
      "--no-first-run --disable-background-networking --virtual-time-budget=30000 --window-size=" +
      window_size + " --user-data-dir=" + quoted((folder / "profile").string()) + " --dump-dom " +
      quoted("file://" + (folder / "page.html").string()) + " 2>" + quoted((folder / "stderr").string()));
  const std::string begin_mark = "[begin]", end_mark = "[end]</pre>";
  const auto first = ended.out.rfind(begin_mark), last = ended.out.rfind(end_mark);
  const std::string said =
      first == std::string::npos || last == std::string::npos || last < first
          ? "NO RESULT, exit code " + std::to_string(ended.exit_code) + "\n" + bytes_of(folder / "stderr") +
                ended.out.substr(0, 2000)
          : ended.out.substr(first + begin_mark.size(), last - first - begin_mark.size());
  return said;
}

}  // namespace lodestone::testing
