#include "tools/view/view_page.h"

#include <fmt/format.h>

#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>

#include "reference/argument_error.h"
#include "scenes/playback.h"
#include "tools/pages/page.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

std::string base64_of(std::span<const std::byte> bytes) {
  using namespace boost::archive::iterators;
  using Text = base64_from_binary<transform_width<const char*, 6, 8>>;
  const char* data = reinterpret_cast<const char*>(bytes.data());
  std::string text(Text(data), Text(data + bytes.size()));
  text.append((4 - text.size() % 4) % 4, '=');
  return text;
}

ordered_json json_of(const Playback& playback) {
  return {{"header", playback.header}, {"blobs", base64_of(playback.blobs)}};
}

ordered_json load_run(const fs::path& run) {
  ordered_json json = json_of(load_playback(playback_of(run)));
  const fs::path fork = fork_of(run);
  json["fork"] = fs::exists(fork) ? json_of(load_playback(fork)) : ordered_json(nullptr);
  return json;
}

}  // namespace

fs::path playback_of(const fs::path& run) { return fs::is_directory(run) ? run / "run.play" : run; }

fs::path fork_of(const fs::path& run) { return fs::is_directory(run) ? run / "fork.play" : fs::path(); }

std::string make_view_page(std::span<const fs::path> runs, bool blind) {
  if (blind && runs.size() != 2)
    throw ArgumentError(fmt::format("--blind: found {} runs, expected two to be told apart", runs.size()));
  ordered_json data{{"blind", blind}, {"runs", ordered_json::array()}};
  std::string title;
  for (const fs::path& run : runs) {
    data["runs"].push_back(load_run(run));
    title += (title.empty() ? "" : " | ") + data["runs"].back()["header"]["label"].get<std::string>();
  }
  return make_page("view.html", blind ? "Which of two?" : title, data);
}

}  // namespace lodestone
