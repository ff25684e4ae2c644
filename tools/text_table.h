// Text in aligned columns.
#pragma once

#include <string>
#include <vector>

namespace lodestone {

/// Rows of cells; the first row is the heading. Columns of numbers are aligned on the right, others on the
/// left.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> heading) : rows_{std::move(heading)} {}
  void add_row(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

  /// One line for each row, with a rule under the heading, which is bold on a terminal. Cells are ASCII.
  std::string text() const;

 private:
  bool is_numeric(std::size_t column) const;
  std::vector<std::vector<std::string>> rows_;
};

/// Milliseconds: two decimals, and below a tenth of a millisecond two digits, so that nothing reads as 0.00.
std::string text_of_ms(double ms);

}  // namespace lodestone
