/// Writes man page and completions into a folder, while rosin is built: rosin_pages FOLDER.
#include "app/pages/pages.hpp"
#include "core/files.hpp"

int main(int, char** argv) {
  using namespace rosin;
  const std::filesystem::path folder = argv[1];
  write_whole(folder / "rosin.1", app::pages::man_page());
  write_whole(folder / "rosin.bash", app::pages::bash_completion());
  write_whole(folder / "_rosin", app::pages::zsh_completion());
  write_whole(folder / "rosin.fish", app::pages::fish_completion());
}
