#include "tools/pages/page.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>

#include "reference/error.h"
#include "signature/file_bytes.h"
#include "tools/pages/page_texts.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kLibraries = "/usr/share/javascript";

std::string read_library(std::string_view name) {
  const fs::path file = fs::path(kLibraries) / name;
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in.is_open() || in.bad() || text.empty())
    throw InputError(
        fmt::format("{}: found no file that can be read, expected that of Debian's package libjs-{}",
                    file.string(), name.substr(0, name.find('/'))));
  return text;
}

std::string own_text(std::string_view name) {
  const auto text = find_page_text(name);
  if (!text) throw std::logic_error(fmt::format("no page text {}", name));
  return std::string(*text);
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '<')
      result += "&lt;";
    else if (c == '&')
      result += "&amp;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

/// Within a script no `</script>` or `<!--` may stand, wherever it comes from: in JSON every < may be written
/// so.
std::string script_json(const nlohmann::ordered_json& data) {
  std::string result;
  for (const char c : data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)) {
    if (c == '<')
      result += "\\u003c";
    else
      result += c;
  }
  return result;
}

class PageMaker {
 public:
  PageMaker(std::string_view title, const nlohmann::ordered_json& data) : title_(title), data_(data) {}

  std::string expand(std::string_view text) const {
    std::string result;
    for (;;) {
      const std::size_t begin = text.find("{{"), end = text.find("}}", begin);
      if (begin == text.npos || end == text.npos) return result.append(text);
      result.append(text.substr(0, begin)).append(value_of(text.substr(begin + 2, end - begin - 2)));
      text.remove_prefix(end + 2);
    }
  }

 private:
  std::string value_of(std::string_view marker) const {
    if (marker == "title") return escaped(title_);
    if (marker == "data") return script_json(data_);
    if (marker.starts_with("text:")) return own_text(marker.substr(5));  // as it is: no markers within
    if (marker.starts_with("library:")) return read_library(marker.substr(8));
    throw std::logic_error(fmt::format("page: unknown marker {}", marker));
  }

  std::string_view title_;
  const nlohmann::ordered_json& data_;
};

}  // namespace

std::string make_page(std::string_view name, std::string_view title, const nlohmann::ordered_json& data) {
  return PageMaker(title, data).expand(own_text(name));
}

void save_page(const fs::path& file, const std::string& page) {
  write_atomically(std::as_bytes(std::span(page)), file);
}

}  // namespace lodestone
