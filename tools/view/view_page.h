// One HTML page that plays recorded runs (scenes/playback.h) side by side.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace lodestone {

/// Where the run is: the file itself, or that in its folder.
std::filesystem::path playback_of(const std::filesystem::path& run);

/// Where its second future is, if it has one; empty for a file.
std::filesystem::path fork_of(const std::filesystem::path& run);

/// `runs` are one to three folders with a run.play, and a fork.play where the run was forked, or such files.
/// `blind`: two runs whose names and places the page hides. Throws InputError for what cannot be read, for
/// other than two runs to be told apart, and where Debian's libjs-three or libjs-chart.js is not installed.
std::string make_view_page(std::span<const std::filesystem::path> runs, bool blind = false);

}  // namespace lodestone
