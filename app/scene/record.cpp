/// Reading records: text by blocks of a mebibyte, NetCDF by hyperslabs, and the check that time runs evenly.
#include "app/scene/record.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <netcdf.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <system_error>

#include "app/scene/header.hpp"
#include "core/error.hpp"
#include "core/files.hpp"
#include "core/stop.hpp"

namespace rosin::app::scene {

namespace {

namespace fs = std::filesystem;
constexpr std::size_t block_length = 1 << 16;

/// The first line of a file that is no record may be anything, a secret too: only what reads as a name is shown.
bool reads_as_name(const std::string& name) {
  constexpr std::size_t longest = 60;
  return !name.empty() && name.size() <= longest && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) || c >= 0x80 || std::string_view("_- .'").find(char(c)) != std::string_view::npos;
  });
}

/// `header`: the line that was taken for it, of a text.
[[noreturn]] void no_column(const RecordSource& source, const std::string& name, std::vector<std::string> known,
                            long header = 0) {
  std::erase_if(known, std::not_fn(reads_as_name));
  const auto near = nearest_name(name, known);
  const auto hint = !near.empty()   ? fmt::format("; did you mean '{}'?", near)
                    : known.empty() ? std::string("; its first line holds no names of columns")
                                    : fmt::format("; it has {}", fmt::join(known, ", "));
  const auto cure =
      header > 0 && near.empty()
          ? fmt::format(
                " (line {} is taken for the header: delete what stands before the names of the columns, or "
                "begin those lines with #)",
                header)
          : std::string();
  throw InputError(fmt::format("{}: has no column '{}'{}{}", source.file.string(), name, hint, cure));
}

/// What a number of the file is worth in SI.
double factor(const RecordSource& source, const RecordColumn& column, const HeaderCell& cell) {
  try {
    return to_si_factor(cell, column.unit, column.si);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", source.file.string(), error.what()));
  }
}

/// Rows of the wanted columns, in the file's units times their factors.
class Rows {
 public:
  virtual ~Rows() = default;
  /// Appends up to block_length rows to `block`; false when there are no more.
  virtual bool read(std::vector<std::vector<double>>& block) = 0;
  /// Where a sample stands: "record.csv:12".
  virtual std::string place(long sample) const = 0;
};

// ---------------------------------------------------------------- text

class TextRows final : public Rows {
 public:
  TextRows(const RecordSource& source, const std::vector<RecordColumn>& wanted)
      : path_(source.file.string()), file_(std::fopen(path_.c_str(), "rb")) {
    if (!file_) throw InputError(fmt::format("{}: cannot be read", path_));
    std::string_view header;
    do
      if (!line(header))
        throw InputError(fmt::format("{}: is empty; a header line with the names of the columns is needed", path_));
    while (skipped(header));
    const auto [separator, cells] = read_header(header);
    separator_ = separator;
    for (const auto& column : wanted) {
      const auto* found = find_column(cells, column.name);
      if (!found) {
        std::vector<std::string> names;
        for (const auto& cell : cells) names.push_back(cell.name);
        no_column(source, column.name, names, line_number_);
      }
      wanted_.push_back({std::size_t(found - cells.data()), factor(source, column, *found), column.name});
    }
    columns_ = cells.size();
  }

  bool read(std::vector<std::vector<double>>& block) override {
    std::vector<double> cells(columns_);
    std::vector<char> present(columns_);
    std::size_t rows = 0;
    for (std::string_view text; rows < block_length && line(text);) {
      if (skipped(text)) continue;
      const auto whole = text;
      std::fill(present.begin(), present.end(), 0);
      std::size_t index = 0;
      for (std::string_view cell; next_cell(text, cell); ++index) {
        if (index >= columns_)
          throw InputError(fmt::format("{}:{}: has more cells than the header has names", path_, line_number_));
        const auto [end, problem] = std::from_chars(cell.data(), cell.data() + cell.size(), cells[index]);
        present[index] = problem == std::errc{} && end == cell.data() + cell.size() && std::isfinite(cells[index]);
      }
      if (index != columns_)
        throw InputError(fmt::format("{}:{}: has {} cells, the header {} names", path_, line_number_, index, columns_));
      for (std::size_t c = 0; c < wanted_.size(); ++c) {
        const auto& column = wanted_[c];
        if (!present[column.index]) not_a_number(whole, column.name);
        block[c].push_back(cells[column.index] * column.factor);
      }
      lines_.push_back(line_number_);
      ++rows;
    }
    first_ = passed_;
    passed_ += long(rows);
    if (lines_.size() > rows) lines_.erase(lines_.begin(), lines_.end() - std::ptrdiff_t(rows));
    return rows > 0;
  }

  std::string place(long sample) const override {
    const auto i = std::size_t(std::clamp(sample - first_, 0L, long(lines_.size()) - 1));
    return fmt::format("{}:{}", path_, lines_[i]);
  }

 private:
  struct Wanted {
    std::size_t index;
    double factor;
    std::string name;
  };

  static std::string_view trimmed(std::string_view text) {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
  }
  static bool skipped(std::string_view text) { return trimmed(text).empty() || trimmed(text).front() == '#'; }

  [[noreturn]] void not_a_number(std::string_view text, const std::string& name) const {
    if (lines_.empty() && holds_units(text))
      throw InputError(
          fmt::format("{}:{}: '{}' holds units in a line of their own; write them into the header, such as "
                      "\"{} (…)\", and delete this line",
                      path_, line_number_, trimmed(text), name));
    if (separator_ != ',' && text.find(',') != std::string_view::npos)
      throw InputError(fmt::format(
          "{}:{}: column '{}' is no number here: '{}'; if a comma is the decimal sign, write a point for it", path_,
          line_number_, name, trimmed(text)));
    throw InputError(
        fmt::format("{}:{}: column '{}' is missing or not a finite number here; nothing is "
                    "interpolated: cut the record, or fill it yourself",
                    path_, line_number_, name));
  }

  /// Takes the first cell off `rest`.
  bool next_cell(std::string_view& rest, std::string_view& cell) const {
    if (separator_ == ' ') {
      rest = trimmed(rest);
      if (rest.empty()) return false;
    } else if (rest.data() == nullptr) {
      return false;
    }
    const auto end = rest.find(separator_);
    cell = trimmed(rest.substr(0, end));
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    return true;
  }

  bool line(std::string_view& text) {
    while (true) {
      const auto* begin = buffer_.data() + at_;
      const auto* end = static_cast<const char*>(std::memchr(begin, '\n', filled_ - at_));
      if (end || (ended_ && filled_ > at_)) {
        if (!end) end = buffer_.data() + filled_;
        text = std::string_view(begin, std::size_t(end - begin));
        at_ = std::min(filled_, at_ + text.size() + 1);
        ++line_number_;
        return true;
      }
      if (ended_) return false;
      std::memmove(buffer_.data(), begin, filled_ - at_);
      filled_ -= at_, at_ = 0;
      if (filled_ == buffer_.size()) throw InputError(fmt::format("{}: a line is longer than a mebibyte", path_));
      const auto got = std::fread(buffer_.data() + filled_, 1, buffer_.size() - filled_, file_.get());
      filled_ += got;
      ended_ = got == 0;
    }
  }

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<char> buffer_ = std::vector<char>(1 << 20);
  std::size_t filled_ = 0, at_ = 0, columns_ = 0;
  bool ended_ = false;
  char separator_ = ' ';
  long line_number_ = 0, first_ = 0, passed_ = 0;
  std::vector<Wanted> wanted_;
  std::vector<long> lines_;  ///< of the last block
};

// ---------------------------------------------------------------- NetCDF

class NetcdfRows final : public Rows {
 public:
  NetcdfRows(const RecordSource& source, const std::vector<RecordColumn>& wanted) : path_(source.file.string()) {
    check(nc_open(path_.c_str(), NC_NOWRITE, &file_.id));
    std::vector<std::string> names;
    int count = 0;
    check(nc_inq_nvars(file_.id, &count));
    for (int v = 0; v < count; ++v) {
      char name[NC_MAX_NAME + 1] = {};
      check(nc_inq_varname(file_.id, v, name));
      names.emplace_back(name);
    }
    for (const auto& column : wanted) {
      Variable variable{0, 1, std::nan(""), column.name};
      if (nc_inq_varid(file_.id, column.name.c_str(), &variable.id) != NC_NOERR) no_column(source, column.name, names);
      int dimensions = 0, dimension = 0;
      check(nc_inq_varndims(file_.id, variable.id, &dimensions));
      if (dimensions != 1)
        throw InputError(fmt::format("{}: '{}' has {} dimensions, one is needed", path_, column.name, dimensions));
      check(nc_inq_vardimid(file_.id, variable.id, &dimension));
      std::size_t length = 0;
      check(nc_inq_dimlen(file_.id, dimension, &length));
      if (!variables_.empty() && length != length_)
        throw InputError(fmt::format("{}: '{}' has {} samples, '{}' has {}", path_, column.name, length,
                                     variables_.front().name, length_));
      length_ = length;
      nc_type type = NC_NAT;
      check(nc_inq_vartype(file_.id, variable.id, &type));
      if (!holds_numbers(type)) throw InputError(fmt::format("{}: '{}' holds no numbers", path_, column.name));
      variable.fill = fill_value(variable);
      HeaderCell cell = header_cell(column.name);
      if (const auto unit = unit_of(variable); !unit.empty()) cell = {column.name, column.name, unit};
      variable.factor = factor(source, column, cell);
      variables_.push_back(variable);
    }
  }

  bool read(std::vector<std::vector<double>>& block) override {
    const std::size_t rows = std::min(block_length, length_ - at_);
    if (rows == 0) return false;
    for (std::size_t c = 0; c < variables_.size(); ++c) {
      const auto& variable = variables_[c];
      auto& list = block[c];
      const auto before = list.size();
      list.resize(before + rows);
      check(nc_get_vara_double(file_.id, variable.id, &at_, &rows, list.data() + before));
      for (std::size_t i = before; i < list.size(); ++i) {
        if (!std::isfinite(list[i]) || list[i] == variable.fill || list[i] == NC_FILL_DOUBLE)
          throw InputError(
              fmt::format("{}: '{}' is missing or not a finite number at sample {}; nothing is "
                          "interpolated: cut the record, or fill it yourself",
                          path_, variable.name, at_ + i - before));
        list[i] *= variable.factor;
      }
    }
    at_ += rows;
    return true;
  }
  std::string place(long sample) const override { return fmt::format("{}: sample {}", path_, sample); }

 private:
  struct Variable {
    int id;
    double factor, fill;
    std::string name;
  };

  static bool holds_numbers(nc_type type) { return type >= NC_BYTE && type <= NC_UINT64 && type != NC_CHAR; }
  /// Type and length of an attribute, or nothing; what the library hands over is as long as the file says.
  std::optional<std::pair<nc_type, std::size_t>> attribute(const Variable& variable, const char* name) const {
    nc_type type = NC_NAT;
    std::size_t length = 0;
    const int status = nc_inq_att(file_.id, variable.id, name, &type, &length);
    if (status == NC_ENOTATT) return std::nullopt;
    check(status);
    return std::pair{type, length};
  }
  double fill_value(const Variable& variable) const {
    double fill = std::nan("");
    const auto found = attribute(variable, "_FillValue");
    if (!found) return fill;
    if (!holds_numbers(found->first) || found->second != 1)
      throw InputError(fmt::format("{}: '{}': its _FillValue must be one number, not {} values", path_, variable.name,
                                   found->second));
    check(nc_get_att_double(file_.id, variable.id, "_FillValue", &fill));
    return fill;
  }
  std::string unit_of(const Variable& variable) const {
    constexpr std::size_t longest = 1000;
    const auto found = attribute(variable, "units");
    if (!found) return "";
    std::string unit;
    if (found->first == NC_CHAR && found->second <= longest) {
      unit.resize(found->second);
      check(nc_get_att_text(file_.id, variable.id, "units", unit.data()));
    } else if (found->first == NC_STRING && found->second == 1) {
      char* given = nullptr;
      check(nc_get_att_string(file_.id, variable.id, "units", &given));
      unit = given ? std::string(given).substr(0, longest) : "";
      nc_free_string(1, &given);
    } else {
      throw InputError(
          fmt::format("{}: '{}': its units must be a text of at most {} characters", path_, variable.name, longest));
    }
    return unit.substr(0, unit.find('\0'));
  }
  void check(int status) const {
    if (status != NC_NOERR) throw InputError(fmt::format("{}: {}", path_, nc_strerror(status)));
  }
  struct Handle {
    int id = -1;
    ~Handle() {
      if (id >= 0) nc_close(id);
    }
  };
  std::string path_;
  Handle file_;
  std::size_t length_ = 0, at_ = 0;
  std::vector<Variable> variables_;
};

/// Rows that another process reads: a damaged NetCDF file may crash or hang the HDF5 library, which must cost neither
/// the command nor what it has computed.
class RowsOfChild final : public Rows {
 public:
  /// `open`: makes the rows within the child.
  RowsOfChild(std::string path, std::size_t columns, const std::function<std::unique_ptr<Rows>()>& open)
      : path_(std::move(path)), columns_(columns) {
    std::array<int, 2> pipe{};
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    child_ = ::fork();
    if (child_ == 0) hand_over(pipe[1], open);
    ::close(pipe[1]);
    from_child_ = pipe[0];
    if (child_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
  }
  ~RowsOfChild() override {
    ::close(from_child_);
    if (child_ <= 0) return;
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  RowsOfChild(const RowsOfChild&) = delete;

  bool read(std::vector<std::vector<double>>& block) override {
    Head head{};
    receive(&head, sizeof head);
    if (head.kind == Kind::end) return false;
    if (head.kind == Kind::refusal) {
      std::string text(std::min(head.length, longest_text), ' ');
      receive(text.data(), text.size());
      throw InputError(text);
    }
    if (head.kind != Kind::rows || head.length > block_length) damaged();
    for (auto& column : block) {
      const auto before = column.size();
      column.resize(before + head.length);
      receive(column.data() + before, head.length * sizeof(double));
    }
    return true;
  }
  std::string place(long sample) const override { return fmt::format("{}: sample {}", path_, sample); }

 private:
  enum class Kind : std::uint64_t { rows = 1, refusal, end };
  struct Head {
    Kind kind;
    std::uint64_t length;  ///< rows, or characters
  };
  static constexpr std::uint64_t longest_text = 10'000;

  [[noreturn]] void hand_over(int pipe, const std::function<std::unique_ptr<Rows>()>& open) const {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const rlimit none{0, 0};
    ::setrlimit(RLIMIT_CORE, &none);
    for (const int crash : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) ::signal(crash, SIG_DFL);
    if (const int silence = ::open("/dev/null", O_WRONLY); silence >= 0) ::dup2(silence, STDERR_FILENO);
    const auto send = [&](const void* bytes, std::size_t length) {
      write_all(pipe, {static_cast<const char*>(bytes), length}, path_);
    };
    try {
      std::string refusal;
      try {
        const auto rows = open();
        std::vector<std::vector<double>> block(columns_);
        while (rows->read(block)) {
          const Head head{Kind::rows, block.front().size()};
          send(&head, sizeof head);
          for (auto& column : block) {
            send(column.data(), column.size() * sizeof(double));
            column.clear();
          }
        }
      } catch (const InputError& error) {
        refusal = std::string(error.what()).substr(0, longest_text);
      }
      const Head head{refusal.empty() ? Kind::end : Kind::refusal, refusal.size()};
      send(&head, sizeof head);
      send(refusal.data(), refusal.size());
    } catch (...) {  // the parent misses the end
    }
    ::_exit(0);
  }

  void receive(void* bytes, std::size_t length) const {
    auto* at = static_cast<char*>(bytes);
    while (length > 0) {
      constexpr int moment = 100;  // ms
      pollfd waiting{from_child_, POLLIN, 0};
      while (::poll(&waiting, 1, moment) <= 0) end_if_stopped();
      const auto got = ::read(from_child_, at, length);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) damaged();
      at += got, length -= std::size_t(got);
    }
  }
  [[noreturn]] void damaged() const {
    throw InputError(fmt::format("{}: is damaged: the library that reads NetCDF crashed on it", path_));
  }

  std::string path_;
  std::size_t columns_;
  pid_t child_ = -1;
  int from_child_ = -1;
};

// ---------------------------------------------------------------- even time

/// Holds times to an even spacing: each step within a tenth of it, and the whole within half a sample of a straight
/// line.
class Clock {
 public:
  void take(const std::vector<double>& times, const Rows& rows) {
    if (step_ == 0) begin(times);
    for (const double t : times) {
      if (count_ > 0) {
        const double step = t - last_;
        if (!(step > 0))
          throw InputError(fmt::format("{}: time does not ascend: {} s follows {} s", rows.place(count_), t, last_));
        if (step > 1.5 * step_)
          throw InputError(
              fmt::format("{}: a gap: time {} s follows {} s, where samples are {:.6g} s apart; nothing is "
                          "interpolated: cut the record there, or fill it yourself",
                          rows.place(count_), t, last_, step_));
        if (std::abs(step - step_) > 0.1 * step_)
          throw InputError(
              fmt::format("{}: samples are not evenly spaced: a step of {:.6g} s among steps of {:.6g} s; "
                          "sample the record evenly first",
                          rows.place(count_), step, step_));
      }
      last_ = t;
      ++count_;
    }
    marks_.emplace_back(count_ - 1, last_);
  }
  double rate() const { return 1 / step_; }
  double mean_rate(const RecordSource& source) const {
    const double step = (last_ - first_) / double(count_ - 1);
    for (const auto& [index, time] : marks_)
      if (std::abs(time - first_ - double(index) * step) > 0.5 * step)
        throw InputError(fmt::format("{}: the clock runs unevenly: sample {} is {:.3g} samples from its place",
                                     source.file.string(), index, (time - first_) / step - double(index)));
    return 1 / step;
  }

 private:
  void begin(const std::vector<double>& times) {
    if (times.size() < 2) throw InputError("a record needs two samples at least");
    std::vector<double> steps;
    for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
    std::ranges::nth_element(steps, steps.begin() + std::ptrdiff_t(steps.size() / 2));
    step_ = steps[steps.size() / 2];
    first_ = times.front();
    if (!(step_ > 0)) throw InputError("times of the record do not ascend");
  }
  double step_ = 0, first_ = 0, last_ = 0;
  long count_ = 0;
  std::vector<std::pair<long, double>> marks_;
};

}  // namespace

RecordEnd read_record(const RecordSource& source,
                      const std::function<void(double, std::span<const std::span<const double>>)>& use) {
  if (!fs::is_regular_file(source.file))
    throw InputError(fmt::format("{}: {}", source.file.string(),
                                 fs::exists(source.file) ? "is not a regular file" : "no such file"));
  auto wanted = source.columns;
  if (source.time) wanted.push_back(*source.time);
  const auto ending = source.file.extension();
  std::unique_ptr<Rows> rows;
  if (ending == ".nc" || ending == ".nc4" || ending == ".cdf")
    rows = std::make_unique<RowsOfChild>(source.file.string(), wanted.size(),
                                         [&] { return std::make_unique<NetcdfRows>(source, wanted); });
  else
    rows = std::make_unique<TextRows>(source, wanted);

  Clock clock;
  RecordEnd end{source.sample_rate, 0};
  std::vector<std::vector<double>> block(wanted.size());
  while (rows->read(block)) {
    if (source.time) {
      clock.take(block.back(), *rows);
      end.sample_rate = clock.rate();
    }
    std::vector<std::span<const double>> columns;
    for (std::size_t c = 0; c < source.columns.size(); ++c) columns.emplace_back(block[c]);
    use(end.sample_rate, columns);
    end.samples += long(block.front().size());
    for (auto& list : block) list.clear();
  }
  if (end.samples < 2)
    throw InputError(fmt::format("{}: has {} samples, too few for anything", source.file.string(), end.samples));
  if (source.time) end.sample_rate = clock.mean_rate(source);
  return end;
}

}  // namespace rosin::app::scene
