#include "tools/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "tools/terminal.h"

namespace lodestone {
namespace {

// Digits, or nothing to show.
bool is_number_or_blank(const std::string& cell) {
  return cell.find_first_not_of(" 0123456789.+-e%x*/") == std::string::npos;
}

}  // namespace

bool TextTable::is_numeric(std::size_t column) const {
  return std::all_of(rows_.begin() + 1, rows_.end(), [&](const auto& row) {
    return column >= row.size() || is_number_or_blank(row[column]);
  });
}

std::string TextTable::text() const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  std::string text;
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i)
      line += is_numeric(i) ? fmt::format("{:>{}}  ", row[i], widths[i])
                            : fmt::format("{:<{}}  ", row[i], widths[i]);
    line.erase(line.find_last_not_of(' ') + 1);
    text += (&row == &rows_.front() ? styled(line, Style::heading) : line) + '\n';
    if (&row == &rows_.front()) {
      std::size_t width = 0;
      for (const std::size_t w : widths) width += w + 2;
      text += std::string(width - 2, '-') + '\n';
    }
  }
  return text;
}

std::string text_of_ms(double ms) {
  return ms >= 0.1 || ms <= 0.0 ? fmt::format("{:.2f}", ms) : fmt::format("{:.2g}", ms);
}

}  // namespace lodestone
