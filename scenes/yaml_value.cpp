#include "scenes/yaml_value.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <unordered_map>

#include "reference/error.h"
#include "reference/output_file.h"
#include "reference/utf8.h"

namespace lodestone {
namespace {

namespace fs = std::filesystem;

int line_of(const YAML::Mark& mark) { return std::max(mark.line, 0) + 1; }

/// How many values a tree holds, and how deep it goes.
struct TreeSize {
  int values = 1, depth = 1;
  std::uintmax_t bytes = 0;  // of its texts and keys
};

TreeSize size_of(const YamlValue& value) {
  TreeSize size{.bytes = value.text.size()};
  const auto include = [&](const YamlValue& part) {
    const TreeSize inner = size_of(part);
    size.values += inner.values, size.bytes += inner.bytes;
    size.depth = std::max(size.depth, 1 + inner.depth);
  };
  for (const YamlValue& item : value.items) include(item);
  for (const YamlEntry& entry : value.entries) size.bytes += entry.key.size(), include(entry.value);
  return size;
}

/// Grows one YamlValue from the parser's events; every rule that is broken throws with its line.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(const std::string& file, const YamlLimits& limits) : file_(file), limits_(limits) {}

  bool complete() const { return documents_ > 0; }
  YamlValue take() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) fail(mark, "document", "a second document", "one document in a file");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    add({.line = line_of(mark), .entries = {}}, mark, anchor);
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    refuse_tag(mark, tag);
    if (text.find('\0') != text.npos) fail(mark, "text", "a zero byte", "none");
    add({.kind = YamlValue::Kind::scalar,
         .line = line_of(mark),
         .quoted = tag == "!",
         .text = text,
         .entries = {}},
        mark, anchor);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open({.kind = YamlValue::Kind::sequence, .line = line_of(mark), .entries = {}}, mark, tag, anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open({.kind = YamlValue::Kind::map, .line = line_of(mark), .entries = {}}, mark, tag, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override { close(); }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end())
      fail(mark, "alias", "an alias inside what it stands for", "no cycle of aliases");
    const TreeSize size = size_of(found->second);
    if (int(open_.size()) + size.depth > limits_.max_depth) fail_depth(mark);
    count(mark, size.values);
    bytes_ += size.bytes;
    if (bytes_ > limits_.max_bytes)
      fail(mark, "size", "more text by aliases", fmt::format("at most {} bytes", limits_.max_bytes));
    place(found->second, mark);
  }

 private:
  struct Open {
    YamlValue value;
    YAML::anchor_t anchor = 0;
    std::optional<std::pair<std::string, int>> key =
        {};  // a map's key that waits for its value, and its line
    std::unordered_map<std::string, int> key_lines = {};
  };

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& what, const std::string& found,
                         const std::string& expected) {
    throw InputError(
        fmt::format("{}:{}: {}: found {}, expected {}", file_, line_of(mark), what, found, expected));
  }
  [[noreturn]] void fail_depth(const YAML::Mark& mark) {
    fail(mark, "nesting", "more levels", fmt::format("at most {}", limits_.max_depth));
  }

  void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
    if (!tag.empty() && tag != "?" && tag != "!") fail(mark, "tag", tag, "plain values without tags");
  }

  void count(const YAML::Mark& mark, int values) {
    values_ += values;
    if (values_ > limits_.max_values)
      fail(mark, "size", "more values", fmt::format("at most {}", limits_.max_values));
  }

  void open(YamlValue value, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    refuse_tag(mark, tag);
    if (int(open_.size()) >= limits_.max_depth) fail_depth(mark);
    count(mark, 1);
    if (!open_.empty() && open_.back().value.kind == YamlValue::Kind::map && !open_.back().key)
      fail_key(mark);
    open_.push_back({std::move(value), anchor});
    open_marks_.push_back(mark);
  }

  void close() {
    Open done = std::move(open_.back());
    const YAML::Mark mark = open_marks_.back();
    open_.pop_back();
    open_marks_.pop_back();
    keep_anchor(done.anchor, done.value);
    place(std::move(done.value), mark);
  }

  void add(YamlValue value, const YAML::Mark& mark, YAML::anchor_t anchor) {
    count(mark, 1);
    keep_anchor(anchor, value);
    place(std::move(value), mark);
  }

  void keep_anchor(YAML::anchor_t anchor, const YamlValue& value) {
    if (anchor != 0) anchors_[anchor] = value;
  }

  void place(YamlValue value, const YAML::Mark& mark) {
    if (open_.empty()) {
      root_ = std::move(value);
    } else if (Open& parent = open_.back(); parent.value.kind == YamlValue::Kind::sequence) {
      parent.value.items.push_back(std::move(value));
    } else if (!parent.key) {
      begin_entry(parent, value, mark);
    } else {
      parent.value.entries.push_back({parent.key->first, parent.key->second, std::move(value)});
      parent.key.reset();
    }
  }

  void begin_entry(Open& map, const YamlValue& key, const YAML::Mark& mark) {
    if (key.kind != YamlValue::Kind::scalar) fail_key(mark);
    const auto [first, is_new] = map.key_lines.emplace(key.text, line_of(mark));
    if (!is_new)
      fail(mark, key.text, "the key a second time", fmt::format("it once (first in line {})", first->second));
    map.key.emplace(key.text, line_of(mark));
  }

  /// To yaml-cpp a map or list whose bracket is not closed is a key of what it is in.
  [[noreturn]] void fail_key(const YAML::Mark& mark) {
    fail(mark, "key", fmt::format("no plain name at column {}", mark.column + 1),
         "a name as key (is a bracket not closed?)");
  }

  std::string file_;
  YamlLimits limits_;
  YamlValue root_;
  int documents_ = 0, values_ = 0;
  std::uintmax_t bytes_ = 0;  // of what aliases stand for
  std::vector<Open> open_;
  std::vector<YAML::Mark> open_marks_;
  std::map<YAML::anchor_t, YamlValue> anchors_;  // finished ones only: an alias to an open one is a cycle
};

std::string read_text(const fs::path& file, const YamlLimits& limits) {
  const auto fail = [&](const std::string& found) {
    throw InputError(
        fmt::format("{}:1: file: found {}, expected a readable scene file", file.string(), found));
  };
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::none) fail(find_reading_fault(file));
  if (!fs::exists(status)) fail("nothing of that name");
  if (fs::is_directory(status)) fail("a folder");
  if (!fs::is_regular_file(status)) fail("a special file");
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error || bytes > limits.max_bytes) fail(fmt::format("a size beyond {} bytes", limits.max_bytes));
  std::ifstream in(file, std::ios::binary);
  std::string text(bytes, '\0');
  if (const std::string fault = find_reading_fault(file); !fault.empty()) fail(fault);
  if (!in.read(text.data(), std::streamsize(bytes))) fail("a file that cannot be read");
  return text;
}

// A message that quotes a zero byte would end there; and names go into files that are UTF-8, too.
void refuse_other_text(const std::string& text, const std::string& name) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t count = text[at] == '\0' ? 0 : count_character_bytes(text, at);
    if (count == 0)
      throw InputError(fmt::format("{}:{}: text: found {}, expected UTF-8 without any", name,
                                   1 + std::count(text.begin(), text.begin() + std::ptrdiff_t(at), '\n'),
                                   text[at] == '\0' ? "a zero byte" : "bytes that are no character"));
    at += count;
  }
}

}  // namespace

YamlValue make_yaml(const std::string& text, const std::string& name, const YamlLimits& limits) {
  refuse_other_text(text, name);
  TreeBuilder builder(name, limits);
  // Before a line feed alone a carriage return ends a line to yaml-cpp: a last one may be left over.
  std::istringstream in(text.substr(0, text.find_last_not_of('\r') + 1));
  try {
    YAML::Parser parser(in);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& e) {
    throw InputError(
        fmt::format("{}:{}: syntax: found an error ({}), expected YAML", name, line_of(e.mark), e.msg));
  }
  if (!builder.complete())
    throw InputError(fmt::format("{}:1: document: found an empty file, expected a scene", name));
  return builder.take();
}

YamlValue load_yaml(const fs::path& file, const YamlLimits& limits) {
  return make_yaml(read_text(file, limits), file.string(), limits);
}

}  // namespace lodestone
