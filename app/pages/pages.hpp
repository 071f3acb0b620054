/// The man page and the shells' completions, written from the verbs and options that the command line is parsed by.
#pragma once
#include <string>

namespace rosin::app::pages {

std::string man_page();
std::string bash_completion();
std::string zsh_completion();
std::string fish_completion();

}  // namespace rosin::app::pages
