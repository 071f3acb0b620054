/// Opening a journal, taking over what it holds, and appending to it.
#include "app/verbs/journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "app/scene/scene.hpp"
#include "core/error.hpp"
#include "core/files.hpp"

namespace rosin::app::verbs {

std::string journal_words(std::string_view verb) { return fmt::format("rosin {}, ", verb); }

std::string journal_header(std::string_view verb, const std::string& key) {
  return fmt::format("{}{} bytes of key\n{}\n", journal_words(verb), key.size(), key);
}

std::string journal_key(const scene::Scene& scene, double tolerance, std::string_view how) {
  std::string key = fmt::format("rosin {}\ntolerance {}\n{}\n", ROSIN_VERSION, tolerance, how);
  if (scene.files_checksum != 0) key += fmt::format("numbers of files {:016x}\n", scene.files_checksum);
  if (!scene.structure)
    for (const auto& quantity : scene.model.parameters())
      key += fmt::format("{} = {}\n", quantity.name, scene.model.get(quantity.name));
  return key + scene.resolved;
}

Journal::Journal(std::filesystem::path path, std::string_view verb, const std::string& key, const Take& take)
    : path_(std::move(path)),
      file_(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666)) {
  const auto refuse = [&](std::string_view why) {
    if (file_ >= 0) ::close(file_);
    throw InputError(fmt::format("{}: {}", path_.string(), why));
  };
  if (file_ < 0)
    refuse(errno == ELOOP ? fmt::format("is a link; no journal of a {} is written through one", verb)
                          : fmt::format("cannot be opened: {}", std::strerror(errno)));
  struct stat status {};
  if (::fstat(file_, &status) != 0 || !S_ISREG(status.st_mode)) refuse("is no regular file");
  if (std::uintmax_t(status.st_size) > largest_journal)
    refuse(fmt::format("has {:.3g} GB, more than the journal of any {}", double(status.st_size) / 1e9, verb));
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0)
    refuse(fmt::format("another rosin computes this {}; wait for it or use another --out", verb));
  std::string content(static_cast<std::size_t>(status.st_size), '\0');
  for (std::size_t read = 0; read < content.size();) {
    const auto got = ::pread(file_, content.data() + read, content.size() - read, static_cast<off_t>(read));
    if (got <= 0) content.resize(read);
    if (got > 0) read += static_cast<std::size_t>(got);
  }
  const auto words = journal_words(verb);
  if (!content.empty() && !content.starts_with(std::string_view(words).substr(0, content.size())))
    refuse(fmt::format("is not the journal of a {}, and is left as it is; move it away or use another --out", verb));
  const std::string expected = journal_header(verb, key);
  std::size_t valid = 0;
  if (content.starts_with(expected)) {
    const auto size = content.size();
    const auto taken = take(std::move(content), expected.size());
    valid = taken.end;
    if (valid < size)
      lost_ = fmt::format("{}: damaged after {} whole records; what follows is computed again", path_.string(),
                          taken.count);
  } else if (content.size() > 0) {
    lost_ = fmt::format("{}: began another {}, with other settings or by another version; it is begun afresh",
                        path_.string(), verb);
  }
  if (::ftruncate(file_, static_cast<off_t>(valid)) != 0 || ::lseek(file_, 0, SEEK_END) < 0)
    throw std::runtime_error(fmt::format("{}: {}", path_.string(), std::strerror(errno)));
  if (valid == 0) write_all(file_, expected, path_);
}

Journal::~Journal() { ::close(file_); }

void Journal::append(std::string_view records) { write_all(file_, records, path_); }

void Journal::remove() { std::filesystem::remove(path_); }

}  // namespace rosin::app::verbs
