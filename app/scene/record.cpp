/// Reading records: text by blocks, NetCDF by hyperslabs, and the check that time runs evenly.
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
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "app/scene/header.hpp"
#include "app/scene/table_file.hpp"
#include "core/error.hpp"
#include "core/files.hpp"
#include "core/stop.hpp"
#include "core/units.hpp"

namespace rosin::app::scene {

namespace {

namespace fs = std::filesystem;
constexpr std::size_t block_length = 1 << 16;

/// What a number of the file is worth in SI.
Conversion conversion(const std::string& place, const RecordColumn& column, const HeaderCell& cell) {
  try {
    return conversion_to_si(cell, column);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", place, error.what()));
  }
}

/// "speed (column 2) in mm/s"
std::string described(const RecordColumn& column, const HeaderCell& cell, std::size_t index) {
  const auto name =
      cell.name.empty() ? fmt::format("column {}", index + 1) : fmt::format("'{}' (column {})", cell.name, index + 1);
  std::string calibration;
  if (column.factor) calibration = fmt::format(", times {:.6g}", *column.factor);
  if (column.offset != 0) calibration += fmt::format(", plus {:.6g}", column.offset);
  auto unit = !column.unit.empty() ? column.unit : cell.unit;
  if (const auto theirs = parse_unit(unit), needed = parse_unit(column.si);
      cell.may_be_name && theirs && needed && !(theirs->dimension == needed->dimension))
    unit.clear();  // it was a part of the name
  if (unit.empty())
    return fmt::format("{}{}, taken as {} since no unit is given", name, calibration, readable_unit(column.si));
  return fmt::format("{}{}{} {}", name, calibration, unit == "1" ? "," : " in", readable_unit(unit));
}

/// Rows of the wanted columns, in the file's units times their factors.
class Rows {
 public:
  virtual ~Rows() = default;
  /// Appends up to block_length rows to `block`, NaN where a number is missing; false when there are no more.
  virtual bool read(std::vector<std::vector<double>>& block) = 0;
  /// Where a sample of the last block stands: "record.csv:12".
  virtual std::string place(long sample) const = 0;
  /// What was found out of the file.
  virtual std::string understood() const = 0;
};

// ---------------------------------------------------------------- text

class TextRows final : public Rows {
 public:
  TextRows(const RecordSource& source, const std::vector<RecordColumn>& wanted) : file_(source.file, source.keys) {
    const auto& head = file_.head();
    const auto place = head.names_line > 0
                           ? fmt::format("{}:{}", file_.path(), std::max(head.names_line, head.units_line))
                           : file_.path();
    if (source.width > 0 && head.columns.size() != std::size_t(source.width))
      throw InputError(fmt::format(
          "{}:{}: has {} columns, where {} are taken without being named: choose them beside the file's name",
          file_.path(), head.first_line, head.columns.size(), source.width));
    std::vector<std::string> columns;
    for (const auto& column : wanted) {
      const auto index = file_.need(column);
      wanted_.push_back({index, conversion(place, column, head.columns[index])});
      columns.push_back(described(column, head.columns[index], index));
    }
    understood_ = fmt::format("{}; {}", head.text(), fmt::join(columns, ", "));
  }

  bool read(std::vector<std::vector<double>>& block) override {
    first_ += long(lines_.size());
    lines_.clear();
    while (lines_.size() < block_length && file_.row(cells_)) {
      for (std::size_t c = 0; c < wanted_.size(); ++c)
        block[c].push_back(cells_[wanted_[c].index] * wanted_[c].to_si.scale + wanted_[c].to_si.shift);
      lines_.push_back(file_.line());
    }
    return !lines_.empty();
  }

  std::string place(long sample) const override {
    const auto i = std::size_t(std::clamp(sample - first_, 0L, long(lines_.size()) - 1));
    return fmt::format("{}:{}", file_.path(), lines_[i]);
  }
  std::string understood() const override { return understood_; }

 private:
  struct Wanted {
    std::size_t index;
    Conversion to_si;
  };
  TableFile file_;
  std::vector<Wanted> wanted_;
  std::vector<double> cells_;
  std::vector<long> lines_;  ///< of the last block
  long first_ = 0;           ///< sample of it
  std::string understood_;
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
      if (column.number > count)
        throw InputError(fmt::format("{}: has no variable {}; it has {}", path_, column.number, count));
      Variable variable{
          column.number - 1, {}, std::nan(""), column.number > 0 ? names[std::size_t(column.number) - 1] : column.name};
      if (column.number == 0 && nc_inq_varid(file_.id, column.name.c_str(), &variable.id) != NC_NOERR) {
        const auto near = nearest_name(column.name, names);
        throw InputError(fmt::format("{}: has no column '{}'{}", path_, column.name,
                                     !near.empty() ? fmt::format("; did you mean '{}'?", near)
                                                   : fmt::format("; it has {}", fmt::join(names, ", "))));
      }
      int dimensions = 0, dimension = 0;
      check(nc_inq_varndims(file_.id, variable.id, &dimensions));
      if (dimensions != 1)
        throw InputError(fmt::format("{}: '{}' has {} dimensions, one is needed", path_, variable.name, dimensions));
      check(nc_inq_vardimid(file_.id, variable.id, &dimension));
      std::size_t length = 0;
      check(nc_inq_dimlen(file_.id, dimension, &length));
      if (!variables_.empty() && length != length_)
        throw InputError(fmt::format("{}: '{}' has {} samples, '{}' has {}", path_, variable.name, length,
                                     variables_.front().name, length_));
      length_ = length;
      nc_type type = NC_NAT;
      check(nc_inq_vartype(file_.id, variable.id, &type));
      if (!holds_numbers(type)) throw InputError(fmt::format("{}: '{}' holds no numbers", path_, variable.name));
      variable.fill = fill_value(variable);
      HeaderCell cell = header_cell(variable.name);
      if (const auto unit = unit_of(variable); !unit.empty()) cell = {variable.name, variable.name, unit};
      variable.to_si = conversion(path_, column, cell);
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
        if (std::isinf(list[i]))
          throw InputError(fmt::format("{}: '{}' is not finite at sample {}", path_, variable.name, at_ + i - before));
        if (list[i] == variable.fill || list[i] == NC_FILL_DOUBLE) list[i] = std::nan("");
        list[i] = list[i] * variable.to_si.scale + variable.to_si.shift;
      }
    }
    at_ += rows;
    return true;
  }
  std::string place(long sample) const override { return fmt::format("{}: sample {}", path_, sample); }
  std::string understood() const override { return "NetCDF"; }

 private:
  struct Variable {
    int id;
    Conversion to_si;
    double fill;
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
  std::string understood() const override { return "NetCDF"; }

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
/// line. Where rows are missing the line begins anew.
class Clock {
 public:
  /// Puts a row without numbers into a block where rows are missing, if they may be. \returns how many are missing.
  long take(std::vector<std::vector<double>>& block, const Rows& rows, bool gaps) {
    if (step_ == 0) begin(block.back());
    long missing = 0;
    for (std::size_t i = 0; i < block.back().size(); ++i, ++rows_) {
      const double t = block.back()[i];
      if (std::isnan(t)) {  // the next one must stand in its place
        last_ += step_;
        ++count_;
        continue;
      }
      if (count_ > 0) {
        const double step = t - last_;
        if (!(step > 0))
          throw InputError(fmt::format("{}: time does not ascend: {} s follows {} s", rows.place(rows_), t, last_));
        if (step > 1.5 * step_) {
          if (!gaps)
            throw InputError(
                fmt::format("{}: a gap: time {} s follows {} s, where samples are {:.6g} s apart; nothing is "
                            "interpolated: cut the record there, or fill it yourself",
                            rows.place(rows_), t, last_, step_));
          missing += std::max(1L, std::lround(step / step_) - 1);
          paused_ += step - 2 * step_;
          ++count_;
          for (auto& column : block) column.insert(column.begin() + std::ptrdiff_t(i), std::nan(""));
          ++i;
        } else if (std::abs(step - step_) > 0.1 * step_) {
          throw InputError(
              fmt::format("{}: samples are not evenly spaced: a step of {:.6g} s among steps of {:.6g} s; "
                          "sample the record evenly first",
                          rows.place(rows_), step, step_));
        }
      }
      last_ = t;
      ++count_;
    }
    marks_.emplace_back(count_ - 1, last_ - paused_);
    return missing;
  }
  double rate() const { return 1 / step_; }
  double mean_rate(const RecordSource& source) const {
    const double step = (last_ - paused_ - first_) / double(count_ - 1);
    for (const auto& [index, time] : marks_)
      if (std::abs(time - first_ - double(index) * step) > 0.5 * step)
        throw InputError(fmt::format("{}: the clock runs unevenly: sample {} is {:.3g} samples from its place",
                                     source.file.string(), index, (time - first_) / step - double(index)));
    return 1 / step;
  }

 private:
  void begin(const std::vector<double>& times) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < times.size(); ++i)
      if (const double step = times[i] - times[i - 1]; std::isfinite(step)) steps.push_back(step);
    if (steps.empty()) throw InputError("a record needs two times that follow each other at least");
    if (std::isnan(times.front())) throw InputError("the first time of the record is missing; cut the record there");
    std::ranges::nth_element(steps, steps.begin() + std::ptrdiff_t(steps.size() / 2));
    step_ = steps[steps.size() / 2];
    first_ = times.front();
    if (!(step_ > 0)) throw InputError("times of the record do not ascend");
  }
  double step_ = 0, first_ = 0, last_ = 0;
  double paused_ = 0;  ///< s in which rows are missing, but for the one that stands for them
  long count_ = 0, rows_ = 0;
  std::vector<std::pair<long, double>> marks_;
};

/// Of a sequence of checksums.
std::uint64_t chained(std::uint64_t before, std::uint64_t next) {
  const std::uint64_t both[] = {before, next};
  return checksum({reinterpret_cast<const char*>(both), sizeof both});
}

}  // namespace

void FilesRead::note(const std::string& understood, std::uint64_t checksum) {
  auto* now = current();
  if (!now) return;
  now->texts.push_back(understood);
  now->checksum = chained(now->checksum, checksum);
}

RecordEnd read_record(const RecordSource& source,
                      const std::function<void(double, std::span<const std::span<const double>>)>& use) {
  if (!fs::is_regular_file(source.file) && !fs::is_fifo(source.file))
    throw InputError(fmt::format("{}: {}", source.file.string(),
                                 fs::exists(source.file) ? "is not a regular file or a pipe" : "no such file"));
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
  RecordEnd end{source.sample_rate};
  std::uint64_t sum = 0;
  std::vector<std::vector<double>> block(wanted.size());
  while (rows->read(block)) {
    if (source.time) {
      end.missing += clock.take(block, *rows, source.gaps);
      end.sample_rate = clock.rate();
    }
    for (std::size_t i = 0; i < block.front().size(); ++i) {
      const auto missing = std::ranges::find_if(block, [&](const auto& column) { return std::isnan(column[i]); });
      if (missing == block.end()) continue;
      ++end.gaps;
      if (source.gaps) continue;
      const auto& column = wanted[std::size_t(missing - block.begin())];
      throw InputError(
          fmt::format("{}: column {} is missing here; nothing is interpolated: cut the table, or fill it yourself",
                      rows->place(end.samples + long(i)),
                      column.number > 0 ? std::to_string(column.number) : fmt::format("'{}'", column.name)));
    }
    std::vector<std::span<const double>> columns;
    for (std::size_t c = 0; c < source.columns.size(); ++c) columns.emplace_back(block[c]);
    use(end.sample_rate, columns);
    end.samples += long(block.front().size());
    for (const auto& list : block)
      sum = chained(sum, checksum({reinterpret_cast<const char*>(list.data()), list.size() * sizeof(double)}));
    for (auto& list : block) list.clear();
  }
  if (end.samples < source.least)
    throw InputError(fmt::format("{}: has {} samples, too few for anything", source.file.string(), end.samples));
  if (source.time) end.sample_rate = clock.mean_rate(source);
  end.understood = fmt::format("{}: {}; {} rows, {} with gaps", source.file.string(), rows->understood(), end.samples,
                               end.gaps == 0 ? "none" : std::to_string(end.gaps));
  if (source.time) end.understood += fmt::format(", one each {:.6g} s", 1 / end.sample_rate);
  if (end.missing > 0) end.understood += fmt::format(", {} rows missing", end.missing);
  FilesRead::note(end.understood, sum);
  return end;
}

}  // namespace rosin::app::scene
