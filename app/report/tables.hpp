/// Key numbers of documents as tables of a page: value, error, unit, meaning. Include only in .cpp files.
#pragma once
#include <string>

#include "app/report/folder.hpp"

namespace rosin::app::report {

/// All numbers of a document but long lists, as HTML.
std::string tables_of(const Result&);

}  // namespace rosin::app::report
