// A command's results: text for people, one JSON object for programs, its rows as a CSV file.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "tools/command.h"

namespace lodestone {

/// What the command line asks for.
struct ResultArguments {
  bool json = false;
  std::filesystem::path csv = {};
};

/// Adds --json to `command`; `arguments` outlives the parsing.
void add_json_argument(Command& command, ResultArguments& arguments);
/// Adds --csv and --json.
void add_table_arguments(Command& command, ResultArguments& arguments,
                         const std::string& csv_what = "file for the table, one line a row");

/// Null for what there is not.
nlohmann::ordered_json or_null(const std::string& text);
nlohmann::ordered_json or_null(const std::optional<double>& value);
nlohmann::ordered_json or_null(const std::optional<int>& value);

/// One object on stdout; with `"incomplete": true` where a signal has ended what it is of.
void print_json(nlohmann::ordered_json json);

/// Rows as a CSV file: a line of the keys of `example`, and one for each of `rows`: null and what is no
/// number are empty cells, the numbers of an array stand in one, with spaces. Throws InputError where the
/// file cannot be written.
void save_csv(const nlohmann::ordered_json& rows, const nlohmann::ordered_json& example,
              const std::filesystem::path& file);

/// With --json that object, else the text.
void print_results(const ResultArguments& arguments, const nlohmann::ordered_json& json,
                   const std::string& text);

/// The same, and with --csv the object's "rows" as a file, whose columns are the keys of `example`.
void print_table(const ResultArguments& arguments, const nlohmann::ordered_json& json,
                 const nlohmann::ordered_json& example, const std::string& text);

}  // namespace lodestone
