/// Pictures: gnuplot scripts beside the data of a results folder. The scripts stay, so that a user can restyle them.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "app/results.hpp"

namespace rosin::app {

// Each writes a script and the data that only it needs into the folder, and returns the names of the files.
std::vector<std::string> write_picture(const std::filesystem::path& folder, const Scene&, const Curve&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const Scene&, const analysis::Run&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const Scene&, const analysis::Cycle&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const Scene&, const analysis::Map&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const Scene&, const Comparison&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const Scene&, const analysis::Design&);
std::vector<std::string> write_picture(const std::filesystem::path& folder, const Scene&,
                                       const std::vector<analysis::lab::Panel>&);

/// A text for gnuplot in single quotes: markup characters are shown as they are, control characters dropped.
std::string single_quoted(std::string_view text);
/// What every script begins with. `format` and `output` may be set by the caller: gnuplot -e "format='png'" map.gp
std::string preamble(const std::string& name, std::string_view what, int width, int height);

/// Draws one script of the folder as SVG and PNG, or all of them if `script` is empty.
struct Drawn {
  std::vector<std::string> files, problems;
};
Drawn draw(const std::filesystem::path& folder, const std::string& script = {});

}  // namespace rosin::app
