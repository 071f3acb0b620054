/// A results folder as one page that needs nothing else: sections, figures, tables, scene, how to reproduce. Include
/// only in .cpp files.
#pragma once
#include <string>
#include <string_view>

#include "app/report/folder.hpp"

namespace rosin::app::report {

std::string page_of(const Folder&);

/// True for what `page_of` has written, in any version.
bool is_report(std::string_view text);

}  // namespace rosin::app::report
